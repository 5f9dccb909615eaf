/** Plotly comes from this server, and only when a page has something to draw. */

let loading = null;

/** Load Plotly once; call early so that it arrives together with the data. */
export function plotly() {
  loading ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = document.body.dataset.plotly;
    script.addEventListener("load", () => resolve(window.Plotly));
    script.addEventListener("error", () => {
      loading = null;
      script.remove();
      reject(new Error("The drawing library did not load. Reload the page to try again."));
    });
    document.head.append(script);
  });
  return loading;
}

let webgl = null;

/** Whether this browser can draw in 3-D; maps and surfaces need it. */
export function hasWebgl() {
  if (webgl === null) {
    const context = document.createElement("canvas").getContext("webgl2");
    webgl = Boolean(context);
    context?.getExtension("WEBGL_lose_context")?.loseContext();
  }
  return webgl;
}

const ARRAYS = {
  f8: Float64Array, f4: Float32Array, i4: Int32Array, u4: Uint32Array, i2: Int16Array, u2: Uint16Array, i1: Int8Array, u1: Uint8Array,
};

/** Values of a figure's column: a plain array, or one packed as base64 by Plotly's Python side. */
export function column(data) {
  if (!data) return [];
  if (!data.bdata) return data;
  const raw = Uint8Array.from(atob(data.bdata), (character) => character.charCodeAt(0));
  const flat = new ARRAYS[data.dtype](raw.buffer);
  const [rows, width] = String(data.shape ?? "").split(",").map(Number);
  if (!width) return flat;
  return Array.from({ length: rows }, (_, row) => flat.subarray(row * width, (row + 1) * width));
}

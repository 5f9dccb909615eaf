/** A resumable upload (tus 1.0): chunks with checksums, pause, and going on after a lost connection or a closed page. */

import { API, Problem, problemOf, request } from "../core/api.js";

const VERSION = { "Tus-Resumable": "1.0.0" };
const SMALLEST = 256 * 1024;
const LARGEST = 16 * 1024 * 1024;
const CHUNK_SECONDS = 1;
const WAITS_MS = [500, 1000, 2000, 4000, 8000, 15000];
const CHECKSUM_MISMATCH = 460;
const PASSING = new Set([0, 408, 409, 423, 425, 429, CHECKSUM_MISMATCH, 500, 502, 503, 504]);
const GONE = new Set([404, 410]);

/** Text as tus wants it in `Upload-Metadata`. */
function base64(text) {
  return btoa(String.fromCharCode(...new TextEncoder().encode(text)));
}

/** SHA-256 of a chunk for the `Upload-Checksum` header; browsers offer it on https and loopback only. */
async function checksum(buffer) {
  if (!globalThis.crypto?.subtle) return {};
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", buffer));
  return { "Upload-Checksum": `sha256 ${btoa(String.fromCharCode(...digest))}` };
}

const sleep = (ms, signal) => new Promise((resolve) => {
  const timer = setTimeout(resolve, ms);
  signal.addEventListener("abort", () => { clearTimeout(timer); resolve(); }, { once: true });
});

export class TusUpload {
  /**
   * @param {File} file
   * @param {Record<string, string>} metadata `filename`, `kind`, `car_id`.
   * @param {{url?: string, created?: (url: string) => void, progress?: (upload: TusUpload) => void}} [options] `url` of an upload to go on with.
   */
  constructor(file, metadata, options = {}) {
    Object.assign(this, { file, metadata, options, url: options.url ?? null, offset: 0, rate: 0, chunk: 4 * SMALLEST, waiting: false });
    this.abort = new AbortController();
  }

  /** Send all that is missing. Returns the upload as the API shows it, or null when paused. */
  async run() {
    this.abort = new AbortController();
    const { signal } = this.abort;
    let failures = 0;
    while (!signal.aborted) {
      const before = this.offset;
      try {
        return await this.attempt(signal);
      } catch (error) {
        if (signal.aborted) break;
        if (!passing(error)) throw error;
        failures = this.offset > before ? 0 : failures + 1;
        this.tell({ waiting: true, rate: 0 });
        await sleep(WAITS_MS[Math.min(failures, WAITS_MS.length - 1)], signal);
      }
    }
    return null;
  }

  async attempt(signal) {
    if (this.url) await this.findOffset(signal);
    if (!this.url) await this.create(signal);
    this.tell({ waiting: false });
    while (this.offset < this.file.size) {
      await this.sendChunk(signal);
      if (!this.judged && this.offset < this.file.size) await this.judge(signal);
    }
    return this.document(signal);
  }

  /** The upload as the API shows it. */
  async document(signal) {
    return (await request(this.url, { signal })).json();
  }

  /** The first bytes show whether a file can be used at all: better told now than after two gigabytes. */
  async judge(signal) {
    this.judged = true;
    const { problem } = await this.document(signal);
    if (problem) throw new Problem(problem, problem.status ?? 422);
  }

  async create(signal) {
    const pairs = Object.entries(this.metadata).filter(([, value]) => value).map(([key, value]) => `${key} ${base64(value)}`);
    const response = await request(`${API}/uploads`, { method: "POST", signal,
      headers: { ...VERSION, "Upload-Length": String(this.file.size), "Upload-Metadata": pairs.join(",") } });
    this.url = new URL(response.headers.get("Location"), location.href).pathname;
    this.offset = 0;
    this.options.created?.(this.url);
  }

  /** Ask how much has arrived; an upload that is no longer known is begun again. */
  async findOffset(signal) {
    const response = await fetch(this.url, { method: "HEAD", headers: VERSION, signal });
    if (GONE.has(response.status)) this.url = null;
    else if (!response.ok) throw await problemOf(response);
    else this.offset = Number(response.headers.get("Upload-Offset"));
  }

  async sendChunk(signal) {
    const began = performance.now();
    const buffer = await this.file.slice(this.offset, this.offset + this.chunk).arrayBuffer();
    const response = await fetch(this.url, { method: "PATCH", body: buffer, signal, headers: { ...VERSION, ...(await checksum(buffer)),
      "Upload-Offset": String(this.offset), "Content-Type": "application/offset+octet-stream" } });
    if (!response.ok) throw await problemOf(response);
    this.offset = Number(response.headers.get("Upload-Offset"));
    const seconds = Math.max(0.001, (performance.now() - began) / 1000);
    const speed = buffer.byteLength / seconds;
    this.tell({ rate: this.rate ? 0.7 * this.rate + 0.3 * speed : speed });
    this.chunk = Math.min(LARGEST, Math.max(SMALLEST, Math.round(speed * CHUNK_SECONDS)));
  }

  /** Stop sending; `run` goes on later. */
  pause() {
    this.abort.abort();
    this.rate = 0;
  }

  /** Take the upload back from the server. */
  async forget() {
    this.pause();
    if (this.url) await discard(this.url);
  }

  /** Seconds to go at the present rate, or null. */
  get secondsLeft() {
    return this.rate > 0 ? (this.file.size - this.offset) / this.rate : null;
  }

  tell(changes) {
    Object.assign(this, changes);
    this.options.progress?.(this);
  }
}

/** Whether waiting a little may help: no connection, a busy server, a damaged chunk, an offset that has moved on. */
function passing(error) {
  if (!(error instanceof Problem)) return error instanceof TypeError;
  return PASSING.has(error.status);
}

/** Remove an unfinished upload from the server; one that is gone already is fine. */
export async function discard(url) {
  const response = await fetch(url, { method: "DELETE", headers: VERSION });
  if (!response.ok && !GONE.has(response.status)) throw await problemOf(response);
}

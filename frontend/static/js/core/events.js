/** Server-sent events that come back by themselves. */

const FIRST_WAIT_MS = 1000;
const LONGEST_WAIT_MS = 20000;

/**
 * Listen to a stream of events until the returned function is called.
 *
 * The browser reconnects by itself and tells the last id it saw. When the server refused (a restart, a proxy), this
 * opens the stream again, less and less often, and calls `resync` so that nothing that happened meanwhile is missed.
 * @param {string} url
 * @param {string[]} types
 * @param {(type: string, data: object) => void} receive
 * @param {{resync?: () => void, status?: (open: boolean) => void}} [hooks]
 */
export function listen(url, types, receive, { resync, status } = {}) {
  let source = null;
  let wait = FIRST_WAIT_MS;
  let timer = null;
  let lost = false;
  const open = () => {
    source = new EventSource(url);
    source.addEventListener("open", () => {
      wait = FIRST_WAIT_MS;
      status?.(true);
      if (lost) resync?.();
      lost = false;
    });
    source.addEventListener("error", () => {
      status?.(false);
      if (source.readyState !== EventSource.CLOSED) return;
      lost = true;
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, LONGEST_WAIT_MS);
    });
    for (const type of types) source.addEventListener(type, (event) => receive(type, JSON.parse(event.data)));
  };
  open();
  return () => {
    clearTimeout(timer);
    source.close();
  };
}

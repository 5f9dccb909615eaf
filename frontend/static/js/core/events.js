/** Server-sent events that come back by themselves. */

const FIRST_WAIT_MS = 1000;
const LONGEST_WAIT_MS = 20000;

/**
 * Listen to a stream of events until the returned function is called.
 *
 * The browser reconnects by itself and tells the last id it saw. When the server refused (a restart, a proxy), this
 * opens the stream again, less and less often. `status` is told each time: what happened while it was closed is for the caller to ask.
 * @param {string} url
 * @param {string[]} types
 * @param {(type: string, data: object) => void} receive
 * @param {{status?: (open: boolean) => void}} [hooks]
 */
export function listen(url, types, receive, { status } = {}) {
  let source = null;
  let wait = FIRST_WAIT_MS;
  let timer = null;
  const open = () => {
    source = new EventSource(url);
    source.addEventListener("open", () => {
      wait = FIRST_WAIT_MS;
      status?.(true);
    });
    source.addEventListener("error", () => {
      status?.(false);
      if (source.readyState !== EventSource.CLOSED) return;
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

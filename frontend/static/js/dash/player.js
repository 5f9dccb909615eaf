/** Plays a trip: a time that moves by itself, by slider or by keys, and a screen that stays awake meanwhile. */

const STEP_S = 5;
const TELL_MS = 50;

export class Player {
  /**
   * @param {number} duration Seconds.
   * @param {(t: number) => void} tell Is told each new time.
   */
  constructor(duration, tell) {
    this.duration = duration;
    this.tell = tell;
    this.t = 0;
    this.times = 5;
    this.playing = false;
    this.changed = () => undefined;
  }

  set(t) {
    this.t = Math.min(this.duration, Math.max(0, t));
    this.tell(this.t);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.t >= this.duration) this.t = 0;
    this.playing = true;
    this.changed();
    this.awake();
    let before = performance.now();
    const tick = (now) => {
      if (!this.playing) return;
      if (now - before >= TELL_MS) {
        this.set(this.t + ((now - before) / 1000) * this.times);
        before = now;
      }
      if (this.t >= this.duration) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  pause() {
    this.playing = false;
    this.lock?.release();
    this.lock = null;
    this.changed();
  }

  /** Keep the phone's screen on while it plays. */
  async awake() {
    try {
      this.lock = await navigator.wakeLock?.request("screen");
      if (!this.playing) this.pause();
    } catch {
      this.lock = null; // low battery, or the page is hidden: it plays all the same
    }
  }

  /** What a key does; true when it did something. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const doing = { " ": () => this.toggle(), ArrowRight: () => this.set(this.t + STEP_S), ArrowLeft: () => this.set(this.t - STEP_S),
      Home: () => this.set(0), End: () => this.set(this.duration) }[event.key];
    doing?.();
    return Boolean(doing);
  }
}

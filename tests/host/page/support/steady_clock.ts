// A clock that moves only when a test says so.

export class SteadyClock {
  time = 0;
  private pending: { at: number; action: () => void }[] = [];

  after(ms: number, action: () => void): void {
    this.pending.push({ at: this.time + ms, action });
  }

  advance(ms: number): void {
    const end = this.time + ms;
    for (;;) {
      const next = this.pending.filter(({ at }) => at <= end).sort((a, b) => a.at - b.at)[0];
      if (next === undefined) {
        break;
      }
      this.pending = this.pending.filter((other) => other !== next);
      this.time = next.at;
      next.action();
    }
    this.time = end;
  }
}

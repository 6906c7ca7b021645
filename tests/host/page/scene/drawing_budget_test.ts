import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { details, DrawingBudget, slowFrame, slowFrameInSoftware } from '../../../../host/page/source/scene/drawing_budget.js';

// A computer that needs `cost(level)` milliseconds for a frame, on a display of 60 Hz.
class Computer {
  now = 0;
  changes = 0;

  constructor(
    readonly budget: DrawingBudget,
    private readonly cost: (level: number) => number,
  ) {}

  draw(seconds: number, hasDrawn: (frame: number) => boolean = () => true): void {
    const end = this.now + seconds * 1000;
    for (let frame = 0; this.now < end; frame += 1) {
      const draws = hasDrawn(frame);
      this.now += draws ? Math.max(1000 / 60, this.cost(this.budget.level)) : 1000 / 60;
      this.changes += this.budget.note(this.now, draws) ? 1 : 0;
    }
  }
}

const lowest = details.length - 1;

describe('the detail of the 3D view', () => {
  it('costs less at each level', () => {
    const pixels = details.map(({ ratio, hasShadows }) => ratio * ratio * (hasShadows ? 2 : 1));
    assert.deepEqual(pixels, [...pixels].sort((a, b) => b - a));
    assert.equal(new Set(pixels).size, pixels.length);
  });

  it('stays where every frame is in time', () => {
    const computer = new Computer(new DrawingBudget(0, slowFrame), () => 10);
    computer.draw(60);
    assert.equal(computer.changes, 0);
  });

  it('becomes less until there are 30 frames a second, and no less', () => {
    const computer = new Computer(new DrawingBudget(0, slowFrame), (level) => [60, 45, 30, 20, 10][level] as number);
    computer.draw(10);
    assert.equal(computer.budget.level, 2);
  });

  it('becomes less until the processor has time, where it draws by itself', () => {
    const computer = new Computer(new DrawingBudget(0, slowFrameInSoftware), (level) => [60, 45, 30, 20, 10][level] as number);
    computer.draw(10);
    assert.equal(computer.budget.level, 3);
  });

  it('becomes as little as there is within three seconds on a very slow computer', () => {
    const computer = new Computer(new DrawingBudget(0, slowFrame), () => 200);
    computer.draw(3.5);
    assert.equal(computer.budget.level, lowest);
    computer.draw(60);
    assert.equal(computer.budget.level, lowest);
  });

  it('comes back when the computer has time again', () => {
    let isBusy = true;
    const computer = new Computer(new DrawingBudget(0, slowFrame), () => (isBusy ? 100 : 5));
    computer.draw(10);
    assert.equal(computer.budget.level, lowest);
    isBusy = false;
    computer.draw(120);
    assert.equal(computer.budget.level, 0);
  });

  it('is tried again less and less often where more of it fails', () => {
    const computer = new Computer(new DrawingBudget(1, slowFrame), (level) => (level === 0 ? 50 : 5));
    computer.draw(100);
    const early = computer.changes;
    assert.ok(early >= 4, 'more detail is tried');
    computer.draw(400);
    computer.changes = 0;
    computer.draw(100);
    assert.ok(computer.changes < early / 2, `found ${computer.changes} changes, and ${early} in the beginning`);
  });

  it('does not change because the page was hidden', () => {
    const computer = new Computer(new DrawingBudget(0, slowFrame), () => 10);
    computer.draw(5);
    computer.now += 3600000;
    computer.draw(5);
    assert.equal(computer.changes, 0);
  });

  it('says nothing of a computer that has nothing to draw', () => {
    const computer = new Computer(new DrawingBudget(2, slowFrame), () => 10);
    computer.draw(60, () => false);
    assert.equal(computer.changes, 0);
  });
});

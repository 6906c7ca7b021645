// The signals to which a viewer has subscribed, and the place of each in a row of the answer.
import type { Signal, TelemetryDocument } from './messages.js';

export interface SubscribedSignal {
  signal: Signal;
  offset: number; // position of the first value of the signal in a row
}

export interface RowLayout {
  signals: SubscribedSignal[];
  width: number;
}

export function rowLayout(signals: readonly Signal[]): RowLayout {
  let width = 0;
  const placed = signals.map((signal) => {
    const offset = width;
    width += signal.count;
    return { signal, offset };
  });
  return { signals: placed, width };
}

// Subscriptions of one connection. Messages that were on their way when the viewer subscribed anew have the number of the
// earlier subscription, so its layout is kept until a message of a later one comes.
export class Subscriptions {
  private last = 0;
  private document: TelemetryDocument | null = null;
  private readonly layouts = new Map<number, RowLayout>();

  // The names for the message `subscribe`, or null if the selection is as before. Each revision of the document ends the
  // subscription, so after it there is always a new one.
  select(document: TelemetryDocument, signals: readonly Signal[]): string[] | null {
    const names = signals.map((signal) => signal.name);
    const current = this.layouts.get(this.last)?.signals.map((placed) => placed.signal);
    const isSame = (signal: Signal, i: number) => signal.name === current?.[i]?.name;
    if (document === this.document && current?.length === signals.length && signals.every(isSame)) {
      return null;
    }
    this.document = document;
    this.last += 1;
    this.layouts.set(this.last, rowLayout(signals));
    return names;
  }

  // The layout of a message, or null if it belongs to no subscription of this connection.
  layoutOf(subscription: number): RowLayout | null {
    for (const number of this.layouts.keys()) {
      if (number < subscription) {
        this.layouts.delete(number);
      }
    }
    return this.layouts.get(subscription) ?? null;
  }
}

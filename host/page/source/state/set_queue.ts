// Changes of parameters on their way. While one `set` waits for its answer, later values of the same words replace each
// other: a slider never builds up a queue, and its last value always arrives.

export interface SetPorts {
  // Both functions reject if the change was refused.
  send(words: string[], gesture: number): Promise<unknown>;
  reset(names: string[]): Promise<unknown>;
  refused(reason: string): void;
}

// A message of the connection is at most 64 KiB.
const mostWords = 400;

// The part of an argument before the value: the parameter that it sets.
function target(word: string): string {
  return word.slice(0, word.indexOf('='));
}

interface Change {
  words: Map<string, string>;
  gesture: number;
}

interface Reset {
  names: string[];
}

export class SetQueue {
  private isSending = false;
  private next: (Change | Reset)[] = [];

  constructor(private readonly ports: SetPorts) {}

  // `gesture`: changes of one drag have one number, and are one entry for undo.
  set(words: readonly string[], gesture: number): void {
    let last = this.next.at(-1);
    if (last === undefined || !('words' in last) || last.gesture !== gesture) {
      last = { words: new Map(), gesture };
      this.next.push(last);
    }
    for (const word of words) {
      // The old word is deleted first, so that a word for all joints stays behind an earlier one for a single joint.
      last.words.delete(target(word));
      last.words.set(target(word), word);
    }
    void this.sendNext();
  }

  // Resets values to those of the file, after the values that were set before: a double click on a slider sets it twice
  // first.
  reset(names: readonly string[]): void {
    this.next.push({ names: [...names] });
    void this.sendNext();
  }

  private async sendNext(): Promise<void> {
    if (this.isSending) {
      return;
    }
    for (let change = this.next.shift(); change !== undefined; change = this.next.shift()) {
      this.isSending = true;
      try {
        if ('words' in change) {
          const words = [...change.words.values()];
          for (let i = 0; i < words.length; i += mostWords) {
            await this.ports.send(words.slice(i, i + mostWords), change.gesture);
          }
        } else {
          await this.ports.reset(change.names);
        }
      } catch (error) {
        this.ports.refused((error as Error).message);
      }
      this.isSending = false;
    }
  }
}

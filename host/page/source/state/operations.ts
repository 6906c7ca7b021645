// Operations that the page requests, and their answers.
import type { OperationRequest } from '../wire/connection.js';
import type { Operations, ResultMessage } from '../wire/messages.js';
import type { PageState } from './page_state.js';

export class OperationRefused extends Error {}

interface Waiting {
  resolve(value: unknown): void;
  reject(error: Error): void;
}

export class OperationQueue {
  private lastKey = 0;
  private readonly waiting = new Map<number, Waiting>();

  constructor(
    private readonly state: PageState,
    private readonly send: (request: OperationRequest) => void,
  ) {}

  // Requests an operation. Rejects with OperationRefused, whose message is that of the program.
  ask<Name extends keyof Operations>(name: Name, parameters: Operations[Name]): Promise<unknown> {
    const key = ++this.lastKey;
    return new Promise((resolve, reject) => {
      this.waiting.set(key, { resolve, reject });
      this.send({ key, epoch: this.state.control.peek()?.epoch ?? 0, name, arguments: parameters });
    });
  }

  // Requests an operation; a refusal becomes a notice, and the result null.
  async tell<Name extends keyof Operations>(name: Name, parameters: Operations[Name]): Promise<unknown> {
    try {
      return await this.ask(name, parameters);
    } catch (error) {
      this.state.addNotice('warning', (error as Error).message);
      return null;
    }
  }

  receive(key: number, result: ResultMessage): void {
    const waiting = this.waiting.get(key);
    this.waiting.delete(key);
    if (result.ok) {
      waiting?.resolve(result.value ?? null);
    } else {
      waiting?.reject(new OperationRefused(result.error ?? 'refused without a reason'));
    }
  }
}

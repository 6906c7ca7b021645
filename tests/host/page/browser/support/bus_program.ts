// A simulated robot whose bus other programs reach: `proleg bus`, and what the programs say of its modules.
import { execFileSync, spawn, type ChildProcess } from 'node:child_process';
import { program, uniform } from './ui_program.js';
import { longest, waitUntil } from './waiting.js';

export class BusProgram {
  // The joint that has got power last; null: none has it now.
  powered: string | null = null;

  private constructor(
    readonly address: string,
    private readonly child: ChildProcess,
  ) {}

  static start(words: string[] = [], file = uniform): Promise<BusProgram> {
    const child = spawn(program, ['bus', file, '--tcp', '0', '--verbose', ...words], { stdio: ['pipe', 'pipe', 'pipe'] });
    return new Promise((resolve, reject) => {
      let output = '';
      let rest = '';
      let bus: BusProgram | null = null;
      const fail = (what: string) => {
        clearTimeout(timer);
        child.kill('SIGKILL');
        reject(new Error(`${program} bus: found ${what}, expected an address; it printed: ${output}`));
      };
      const timer = setTimeout(() => fail('no address in time'), longest);
      const read = (chunk: Buffer) => {
        output += chunk.toString();
        const address = /tcp:127\.0\.0\.1:\d+/.exec(output)?.[0];
        if (bus === null && address !== undefined) {
          clearTimeout(timer);
          bus = new BusProgram(address, child);
          resolve(bus);
        }
        const lines = (rest + chunk.toString()).split('\n');
        rest = lines.pop() ?? '';
        for (const line of lines) bus?.notePower(line);
      };
      child.stdout.on('data', read);
      child.stderr.on('data', read);
      child.on('error', (error) => fail(error.message));
      child.on('exit', (code) => fail(`exit status ${code}`));
    });
  }

  private notePower(line: string): void {
    const match = /: (\S+) has( no)? power/.exec(line);
    if (match !== null) this.powered = match[2] === undefined ? (match[1] as string) : null;
  }

  // A person switches the supply of the robot.
  switchSupply(state: 'off' | 'on'): void {
    this.child.stdin?.write(`${state}\n`);
  }

  // The joint that moves: a person sees it on the table.
  async movingJoint(): Promise<string> {
    await waitUntil(() => this.powered !== null);
    return this.powered as string;
  }

  // What a program prints about the modules.
  ask(...words: string[]): string {
    return execFileSync(program, [...words, '--bus', this.address], { encoding: 'utf8', stdio: ['ignore', 'pipe', 'ignore'] });
  }

  // Serial numbers by node ids.
  serials(): Map<number, number> {
    const { nodes } = JSON.parse(this.ask('scan', '--json')) as { nodes: { node: number; serial: number }[] };
    return new Map(nodes.map(({ node, serial }) => [node, serial]));
  }

  async end(): Promise<void> {
    if (this.child.exitCode !== null || this.child.signalCode !== null) return;
    const ended = new Promise((resolve) => this.child.once('exit', resolve));
    this.child.kill('SIGINT');
    await ended;
  }
}

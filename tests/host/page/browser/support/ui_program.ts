// Starts `proleg ui`, and reads the address that it prints.
import { spawn, type ChildProcess } from 'node:child_process';
import { longest } from './waiting.js';

export const program = process.env['PROLEG_PROGRAM'] ?? 'build/host/bin/proleg';

export const uniform = 'sim/scenarios/travelling_wave/uniform.simulation.xml';
export const sixty = 'sim/scenarios/long_chain/sixty.simulation.xml';

// A robot stops, and control may go to another viewer, when the page of its driver is silent for 0.4 s; a STOP is answered
// within half a second. A browser on a busy computer can be slower: in slow time (tests/support/slow_time) these are 1.6
// seconds and two.
const slowTimeLibrary = process.env['PROLEG_SLOW_TIME_LIBRARY'];
export const slowTime = slowTimeLibrary === undefined ? {} : { LD_PRELOAD: slowTimeLibrary, PROLEG_SLOW_TIME: '4' };

export class UiProgram {
  private constructor(
    readonly address: string,
    private readonly child: ChildProcess,
  ) {}

  // A simulation, paused at tick 0.
  static start(file: string = uniform, more: string[] = []): Promise<UiProgram> {
    return UiProgram.serve([file, '--paused', ...more]);
  }

  // A robot on a simulated bus.
  static startOnBus(file: string = uniform, more: string[] = []): Promise<UiProgram> {
    return UiProgram.serve([file, '--bus', `sim:${file}`, ...more], slowTime);
  }

  static serve(words: string[], environment: NodeJS.ProcessEnv = {}): Promise<UiProgram> {
    const options = ['--no-browser', '--port', '0', '--page', 'build/page'];
    const child = spawn(program, ['ui', ...words, ...options], { stdio: ['ignore', 'pipe', 'pipe'], env: { ...process.env, ...environment } });
    return new Promise((resolve, reject) => {
      let output = '';
      const timer = setTimeout(() => fail('no address in time'), longest);
      const fail = (what: string) => {
        clearTimeout(timer);
        child.kill('SIGKILL');
        reject(new Error(`${program} ui: found ${what}, expected an address; it printed: ${output}`));
      };
      const read = (chunk: Buffer) => {
        output += chunk.toString();
        const address = /https?:\/\/\S+\/#\S+/.exec(output)?.[0];
        if (address !== undefined) {
          clearTimeout(timer);
          resolve(new UiProgram(address, child));
        }
      };
      child.stdout.on('data', read);
      child.stderr.on('data', read);
      child.on('error', (error) => fail(error.message));
      child.on('exit', (code) => fail(`exit status ${code}`));
    });
  }

  get pid(): number {
    return this.child.pid as number;
  }

  // As Ctrl+C does.
  async end(): Promise<void> {
    if (this.child.exitCode !== null || this.child.signalCode !== null) {
      return;
    }
    const ended = new Promise((resolve) => this.child.once('exit', resolve));
    this.child.kill('SIGINT');
    await ended;
  }

  // As a crash does.
  async kill(): Promise<void> {
    const ended = new Promise((resolve) => this.child.once('exit', resolve));
    this.child.kill('SIGKILL');
    await ended;
  }
}

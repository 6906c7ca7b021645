// Facts about the recording: its origin, its parameters at the start, its figures.
import { formatRaw } from '../state/parameter_values.js';
import type { Documents, Parameter, RecordingDocument } from '../wire/messages.js';
import type { PlayedRecording } from './player_app.js';

// The text of one value, or of those of all joints from the head.
function valuesText(parameter: Parameter): string {
  const texts = parameter.file.map((raw) => formatRaw(raw, parameter));
  return new Set(texts).size === 1 ? (texts[0] as string) : texts.join('  ');
}

// The text with six digits of a long number; hashes and words are unchanged.
function shortText(text: string): string {
  return /^-?\d+\.\d{5,}(e-?\d+)?$/.test(text) ? String(Number(Number(text).toPrecision(6))) : text;
}

type Facts = Map<string, string>;

// One row for each fact. `second`: those of a second recording, in a column of their own.
function FactRows({ facts, second }: { facts: Facts; second: Facts | null }) {
  const names = new Set([...facts.keys(), ...(second?.keys() ?? [])]);
  return (
    <tbody>
      {[...names].map((name) => {
        const texts = [facts, ...(second === null ? [] : [second])].map((column) => column.get(name) ?? '');
        return (
          <tr key={name} class={second !== null && texts[0] !== texts[1] ? 'differs' : undefined}>
            <th scope="row">{name}</th>
            {texts.map((text, i) => (
              <td key={i} title={text}>
                {shortText(text)}
              </td>
            ))}
          </tr>
        );
      })}
    </tbody>
  );
}

function parameterFacts(parameters: Documents['parameters']): Facts {
  const shown = parameters.filter((value): value is Parameter => !value.internal);
  return new Map(shown.map((parameter) => [`${parameter.slot}.${parameter.name}`, `${valuesText(parameter)} ${parameter.unit}`]));
}

function recordingFacts(recording: RecordingDocument): Facts {
  return new Map([
    ['program', `${recording.program}, ${recording.build_id}`],
    ['core', recording.core_fingerprint],
    ['seed', recording.seed],
    ...recording.results.map(({ name, value }): [string, string] => [name, value]),
  ]);
}

// What the facts of a second recording need.
interface SecondRecording {
  readonly recording: RecordingDocument;
  readonly parameters: Documents['parameters'];
}

export function RecordingFacts({ app, second = null }: { app: PlayedRecording; second?: SecondRecording | null }) {
  const robot = app.state.robot.value;
  return (
    <section class="panel facts-panel" aria-label="Recording">
      <h2>Parameters at the start{second !== null && ', of both recordings'}</h2>
      <table data-testid="parameters">
        <FactRows facts={parameterFacts(app.parameters)} second={second && parameterFacts(second.parameters)} />
      </table>
      <h2>Recording{second !== null && ', and the second'}</h2>
      <table data-testid="facts">
        <FactRows
          facts={new Map([['scenario', robot?.file ?? ''], ...recordingFacts(app.recording)])}
          second={second && recordingFacts(second.recording)}
        />
      </table>
    </section>
  );
}

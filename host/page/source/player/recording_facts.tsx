// Facts about the recording: its origin, its parameters at the start, its figures.
import { formatRaw } from '../state/parameter_values.js';
import type { Parameter } from '../wire/messages.js';
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

function Row({ name, children }: { name: string; children: string }) {
  return (
    <tr>
      <th scope="row">{name}</th>
      <td title={children}>{shortText(children)}</td>
    </tr>
  );
}

export function RecordingFacts({ app }: { app: PlayedRecording }) {
  const { recording } = app;
  const robot = app.state.robot.value;
  const parameters = app.parameters.filter((value): value is Parameter => !value.internal);
  return (
    <section class="panel facts-panel" aria-label="Recording">
      <h2>Parameters at the start</h2>
      <table data-testid="parameters">
        <tbody>
          {parameters.map((parameter) => (
            <Row key={`${parameter.slot}.${parameter.name}`} name={`${parameter.slot}.${parameter.name}`}>
              {`${valuesText(parameter)} ${parameter.unit}`}
            </Row>
          ))}
        </tbody>
      </table>
      <h2>Recording</h2>
      <table data-testid="facts">
        <tbody>
          <Row name="scenario">{robot?.file ?? ''}</Row>
          <Row name="program">{`${recording.program}, ${recording.build_id}`}</Row>
          <Row name="core">{recording.core_fingerprint}</Row>
          <Row name="seed">{recording.seed}</Row>
          {recording.results.map(({ name, value }) => (
            <Row key={name} name={name}>
              {value}
            </Row>
          ))}
        </tbody>
      </table>
    </section>
  );
}

// The recordings in the folder of the program, the newest first.
import { useSignal } from '@preact/signals';
import { TableHead } from '../panels/table_head.js';
import type { RecordedFile } from '../wire/messages.js';
import type { RecordingsApp } from './recordings_app.js';

// One format for all rows: to make it takes longer than to use it.
const timeFormat = new Intl.DateTimeFormat(undefined, { dateStyle: 'short', timeStyle: 'medium' });

function sizeText(bytes: number): string {
  const units = ['B', 'kB', 'MB', 'GB'];
  let size = bytes;
  let unit = 0;
  for (; size >= 1000 && unit < units.length - 1; unit += 1) {
    size /= 1000;
  }
  return `${size >= 100 || unit === 0 ? Math.round(size) : size.toFixed(1)} ${units[unit]}`;
}

function durationText(seconds: number): string {
  if (seconds < 60) return `${seconds.toFixed(2)} s`;
  const whole = Math.round(seconds);
  const two = (value: number) => String(value).padStart(2, '0');
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor((whole % 3600) / 60)];
  return hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)} h` : `${minutes}:${two(whole % 60)} min`;
}

function FileRow({ app, file }: { app: RecordingsApp; file: RecordedFile }) {
  const time = new Date(file.time_ms);
  const first = app.comparing.value;
  const isBusy = app.opening.value !== null;
  return (
    <tr>
      <th scope="row">
        <button
          type="button"
          onClick={() => void (first === null ? app.open(file.name) : app.compareWith(file.name))}
          disabled={isBusy || file.name === first}
        >
          {file.name}
        </button>
      </th>
      {file.problem ? (
        <td colSpan={5} class="problem">
          {file.problem}
        </td>
      ) : (
        <>
          <td>{file.scenario ?? '…'}</td>
          <td>{file.algorithms?.join(', ') ?? ''}</td>
          <td class="number">{file.seconds === undefined ? '' : durationText(file.seconds)}</td>
          <td>{file.finished === undefined ? '' : file.finished ? 'finished' : 'growing, or interrupted'}</td>
          <td>{file.program ?? ''}</td>
        </>
      )}
      <td class="number">{sizeText(file.bytes)}</td>
      <td class="number" title={time.toISOString()}>
        {timeFormat.format(time)}
      </td>
      <td>
        {first === null && !file.problem && (
          <button type="button" class="compare" disabled={isBusy} onClick={() => app.chooseSecond(file.name)} aria-label={`Compare ${file.name} with another recording`}>
            Compare …
          </button>
        )}
      </td>
    </tr>
  );
}

const fewRows = 50; // at first, and with each click more

export function RecordingList({ app }: { app: RecordingsApp }) {
  const wanted = useSignal('');
  const mostRows = useSignal(fewRows);
  const files = app.files.value;
  const folder = app.page.state.recordings.value?.folder ?? '';
  const words = wanted.value.toLowerCase().split(/\s+/).filter(Boolean);
  const text = (file: RecordedFile) => `${file.name} ${file.scenario ?? ''} ${file.algorithms?.join(' ') ?? ''} ${file.program ?? ''}`;
  const matching = (files ?? []).filter((file) => words.every((word) => text(file).toLowerCase().includes(word)));
  const left = matching.length - mostRows.value;
  return (
    <section class="panel recording-list" aria-label="List of recordings">
      <div class="panel-head">
        <h2>Recordings in {folder}</h2>
        <span class="space" />
        <label>
          Find{' '}
          <input type="search" value={wanted.value} onInput={(event) => (wanted.value = event.currentTarget.value)} />
        </label>
      </div>
      {app.problem.value !== null && (
        <p class="problem" role="alert">
          {app.problem.value}
        </p>
      )}
      {app.comparing.value !== null && (
        <p class="hint" role="status" data-testid="comparing">
          Choose the recording to compare with <strong>{app.comparing.value}</strong>.{' '}
          <button type="button" onClick={() => app.chooseSecond(null)}>
            Cancel
          </button>
        </p>
      )}
      {files === null && <p class="hint">Reading the folder …</p>}
      {files?.length === 0 && <p class="hint">No recordings yet. “Record” on the page Live makes one, and so does “proleg simulate --record”.</p>}
      {matching.length > 0 && (
        <div class="table-frame" tabIndex={0} role="group" aria-label="Table of recordings">
          <table data-testid="recordings">
            <TableHead titles={['file', 'scenario', 'algorithm', 'length', 'state', 'program', 'size', 'changed']}>
              <td />
            </TableHead>
            <tbody>
              {matching.slice(0, mostRows.value).map((file) => (
                <FileRow key={file.name} app={app} file={file} />
              ))}
            </tbody>
          </table>
        </div>
      )}
      {left > 0 && (
        <p class="hint">
          <button type="button" onClick={() => (mostRows.value += fewRows)}>
            {Math.min(left, fewRows)} of {left} more
          </button>{' '}
          Or write a part of the name above.
        </p>
      )}
    </section>
  );
}

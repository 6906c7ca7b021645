// Exports pictures of the panels, and a table of the values in strip and plots.
import { useSignal } from '@preact/signals';
import { panelImage, save } from './panel_image.js';
import type { OpenedRecording } from './opened_recording.js';
import { tsvPieces, type TsvColumn } from './tsv_export.js';

const panels = [
  { title: '3D view', selector: '.scene-panel' },
  { title: 'strip', selector: '.strip-panel' },
  { title: 'plots', selector: '.plot-panel' },
  { title: 'x over y', selector: '.xy-panel' },
] as const;

// The columns: all joints of the strip, then the lines of the plots that are not among them.
function shownColumns(opened: OpenedRecording): TsvColumn[] {
  const signals = opened.state.telemetry.value?.signals ?? [];
  const strip = signals.find((signal) => signal.name === opened.selection.strip.value);
  const columns: TsvColumn[] = Array.from({ length: strip?.count ?? 0 }, (_, index) => ({ signal: strip as TsvColumn['signal'], index }));
  for (const { signal: name, index } of opened.selection.groups.value.flatMap((group) => group.lines)) {
    const signal = signals.find((candidate) => candidate.name === name);
    if (signal !== undefined && !columns.some((column) => column.signal === signal && column.index === index)) {
      columns.push({ signal, index });
    }
  }
  return columns;
}

export function ExportTools({ opened }: { opened: OpenedRecording }) {
  const progress = useSignal<number | null>(null);
  const name = (opened.client.file.split('/').at(-1) ?? 'run').replace(/\.proleg$/, '');
  const fail = (error: unknown) => (opened.failure.value = (error as Error).message);
  const range = () => {
    const { from, to } = opened.time.range();
    const { first_tick, last_tick } = opened.recording;
    return { from: Math.max(first_tick, Math.ceil(from)), to: Math.min(last_tick, Math.floor(to)) };
  };
  const saveImage = ({ title, selector }: (typeof panels)[number]) => {
    const panel = document.querySelector(`.recorded ${selector}`);
    const { from, to } = range();
    const seconds = (tick: number) => (tick / opened.tickRate).toFixed(2);
    const time = title === '3D view' ? `at ${seconds(opened.time.cursor.peek())} s` : `${seconds(from)} to ${seconds(to)} s`;
    if (panel !== null) {
      panelImage(panel, `${opened.client.file}, ${time}`).then(
        (blob) => save(blob, `${name}-${title.replace(/ /g, '_')}.png`),
        fail,
      );
    }
  };
  const saveTable = async () => {
    const { from, to } = range();
    const request = { columns: shownColumns(opened), from, to, tickSeconds: 1 / opened.tickRate, robot: opened.state.robot.value };
    const pieces: string[] = [];
    let ticks = 0;
    progress.value = 0;
    try {
      for await (const piece of tsvPieces(opened.ask, request)) {
        pieces.push(piece);
        ticks += 1024;
        progress.value = Math.min(1, ticks / (to - from + 1));
      }
      save(new Blob(pieces, { type: 'text/tab-separated-values' }), `${name}.tsv`);
    } catch (error) {
      fail(error);
    }
    progress.value = null;
  };
  return (
    <div class="export-tools" role="group" aria-label="Export">
      <span class="unit">Picture (PNG) of</span>
      {panels.map((panel) => (
        <button type="button" key={panel.title} onClick={() => saveImage(panel)}>
          {panel.title}
        </button>
      ))}
      <button
        type="button"
        disabled={progress.value !== null}
        onClick={() => void saveTable()}
        title="Every tick of the part that is shown: the signal of the strip, and the lines"
      >
        {progress.value === null ? 'Table (TSV)' : `Table … ${Math.round(progress.value * 100)} %`}
      </button>
    </div>
  );
}

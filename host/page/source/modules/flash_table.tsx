// What is done to each module, how far it is, and what it runs in the end.
import { TableHead } from '../panels/table_head.js';
import type { Advance, FlashRow } from './flash_rows.js';
import { TableFrame } from './job_controls.js';
import { refText, serialText } from './module_rows.js';

const actions: Record<FlashRow['action'], string> = { flash: 'flash', same: 'nothing to do', refuse: 'REFUSED' };

export function AdvanceCell({ advance, wait }: { advance: Advance | null; wait: string }) {
  if (advance === null) return <td>{wait}</td>;
  const { part, text, isGood } = advance;
  return (
    <td class={isGood === null ? '' : `module ${isGood ? 'good' : 'bad'}`}>
      {isGood === null ? (
        <span class="advance">
          <progress max={1} value={part} aria-label="Part that is done" />
          <span class="number">{Math.floor(100 * part)} %</span> {text}
        </span>
      ) : (
        `${isGood ? '✓' : '✗'} ${text}`
      )}
    </td>
  );
}

export function FlashTable({ rows, isGoing }: { rows: readonly FlashRow[]; isGoing: boolean }) {
  return (
    <TableFrame label="Table of modules and the image">
      <table class="wrapped" data-testid="verdicts">
        <TableHead titles={['module', 'serial number', 'what is done', 'reason', 'how far', 'runs now']} />
        <tbody>
          {rows.map((row) => (
            <tr key={row.serial} class={row.action === 'refuse' ? 'refused' : ''}>
              <th scope="row">{refText(row)}</th>
              <td class="code-text">{serialText(row.serial)}</td>
              <td class={row.action === 'refuse' ? 'module bad' : ''}>{actions[row.action] ?? row.action}</td>
              <td class="text">{row.reason}</td>
              <AdvanceCell advance={row.advance} wait={isGoing && row.action === 'flash' ? 'waits' : '–'} />
              <td>{row.now ?? row.before?.version ?? '–'}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </TableFrame>
  );
}

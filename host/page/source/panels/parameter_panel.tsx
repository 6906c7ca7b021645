// The parameters of all slots, and the internal values that a change may overwrite.
import { useSignal } from '@preact/signals';
import { openDialog } from '../view/dialogs.js';
import type { Stores } from '../view/robot_view.js';
import { summarise } from '../state/parameter_values.js';
import type { Parameter } from '../wire/messages.js';
import { DistortionForm } from './distortion_form.js';
import { redoIcon, swapIcon, undoIcon } from './icons.js';
import { ParameterRow } from './parameter_row.js';
import { sentencesAreShown, toggleSentences } from './parameter_sentence.js';

function Toolbar({ app, changed, filter }: { app: Stores<'operations' | 'state'>; changed: number; filter: { value: boolean } }) {
  const session = app.state.session.value;
  const simulation = app.state.simulation.value;
  const isHolder = app.state.isHolder.value;
  const tell = app.operations;
  return (
    <div class="toolbar" role="toolbar" aria-label="Changes of parameters">
      <button
        type="button"
        disabled={!isHolder || !session?.undo}
        onClick={() => void tell.tell('undo', {})}
        title={session?.undo ? `Undo the change of ${session.undo} (Ctrl + Z)` : 'Nothing to undo'}
      >
        {undoIcon} Undo
      </button>
      <button
        type="button"
        disabled={!isHolder || !session?.redo}
        onClick={() => void tell.tell('redo', {})}
        title={session?.redo ? `Redo the change of ${session.redo} (Ctrl + Y)` : 'Nothing to redo'}
      >
        {redoIcon} Redo
      </button>
      {simulation !== null && (
        <button
          type="button"
          disabled={!isHolder}
          onClick={() => void tell.tell('swap', {})}
          title="Two sets of parameters to compare: change to the other one (B)"
        >
          {swapIcon} Set {simulation.set}
        </button>
      )}
      <button
        type="button"
        disabled={!isHolder || changed === 0}
        onClick={() => void tell.tell('reset', {})}
        title="All parameters back to the file"
      >
        Reset all
      </button>
      <button
        type="button"
        aria-pressed={filter.value}
        onClick={() => (filter.value = !filter.value)}
        title="Show only what differs from the file"
      >
        Changed ({changed})
      </button>
      <button
        type="button"
        aria-pressed={sentencesAreShown.value}
        onClick={toggleSentences}
        title="A sentence below each name: what the parameter changes"
      >
        Explain
      </button>
      <button
        type="button"
        onClick={() => (openDialog.value = 'value_table')}
        title="All values as a table, to copy from and paste into (V)"
      >
        Table…
      </button>
      {simulation !== null && (
        <>
          <button
            type="button"
            onClick={() => (openDialog.value = 'file_diff')}
            title="Write the values into the file of the robot, or save a copy of all its files (W)"
          >
            Apply to file…
          </button>
          <button type="button" onClick={() => (openDialog.value = 'command_line')} title="The command that gives the same run (X)">
            Command line
          </button>
        </>
      )}
    </div>
  );
}

export function ParameterPanel({ app }: { app: Stores<'newGesture' | 'operations' | 'selection' | 'sets' | 'state'> }) {
  const onlyChanged = useSignal(false);
  const robot = app.state.robot.value;
  const all = app.state.parameters.value;
  const changed = all.filter((parameter) => summarise(parameter).isChanged);
  const shown = onlyChanged.value ? changed : all;
  const slots = [...new Set(all.map((parameter) => parameter.slot))];
  const ofSlot = (slot: number): Parameter[] => shown.filter((parameter) => parameter.slot === slot);
  const internal = app.state.internalValues.value;
  return (
    <section class="panel parameter-panel" aria-label="Parameters">
      <h2>Parameters</h2>
      <Toolbar app={app} changed={changed.length} filter={onlyChanged} />
      {slots.map((slot) => (
        <div key={slot} class="slot">
          <h3>
            {slot}. {robot?.slots.find((candidate) => candidate.number === slot)?.algorithm ?? ''}
          </h3>
          {ofSlot(slot).map((parameter) => (
            <ParameterRow key={parameter.name} app={app} parameter={parameter} />
          ))}
        </div>
      ))}
      {onlyChanged.value && changed.length === 0 && <p class="hint">All parameters are as in the file.</p>}
      {internal.length > 0 && <DistortionForm app={app} values={internal} />}
    </section>
  );
}

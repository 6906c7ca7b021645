// What is open in front of the page, and what Esc does: it closes that, pauses a simulation, or stops a robot.
import { openDialog } from './dialogs.js';
import type { Stores } from './robot_view.js';

interface Layer {
  isOpen(): boolean;
  close(): void;
}

const layers: Layer[] = [];

// Adds something that Esc closes while it is open. Of several, Esc closes the one that was added last. Returns the function
// that removes it.
export function addFront(layer: Layer): () => void {
  layers.push(layer);
  return () => void layers.splice(layers.indexOf(layer), 1);
}

// Closes what is in front: a dialog, which has nothing in front of it, or the last layer. False: nothing is open.
export function closeFront(): boolean {
  if (openDialog.peek() !== 'none') {
    openDialog.value = 'none';
    return true;
  }
  const front = layers.filter((layer) => layer.isOpen()).at(-1);
  front?.close();
  return front !== undefined;
}

export function pressEscape({ operations, state, stop }: Stores<'operations' | 'state' | 'stop'>): void {
  // While joints move on the table, whatever the page shows.
  if (state.moduleJob.peek()?.kind === 'assign' && state.moduleJob.peek()?.state !== 'ended') return stop.press();
  // In a simulation nothing can be hurt while something is closed first. A program without a robot can only become one.
  const isSimulation = state.robot.peek()?.kind === 'simulation' || state.isAlone.peek();
  if (isSimulation && closeFront()) return;
  const runState = state.simulation.peek()?.state;
  if (!isSimulation || !state.isHolder.peek()) {
    stop.press();
  } else if (runState === 'running' || runState === 'paused') {
    // While it is paused this ends a step of many ticks, or a recording that is computed again.
    void operations.tell('pause', {});
  }
}

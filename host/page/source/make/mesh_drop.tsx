// Files that are dragged over the page Make: a hint while they are there, and what is done with them.
import { useSignal } from '@preact/signals';
import { useLayoutEffect } from 'preact/hooks';
import type { MakeApp } from './make_app.js';

function hasFiles(event: DragEvent): boolean {
  return event.dataTransfer?.types.includes('Files') === true;
}

export function MeshDrop({ app }: { app: MakeApp }) {
  const isOver = useSignal(false);
  useLayoutEffect(() => {
    const over = (event: DragEvent) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      isOver.value = true;
    };
    const leave = (event: DragEvent) => {
      if (event.relatedTarget === null) isOver.value = false;
    };
    const drop = (event: DragEvent) => {
      if (!hasFiles(event)) return;
      event.preventDefault(); // else the browser would show the file in the place of the page
      isOver.value = false;
      app.dropMesh([...(event.dataTransfer?.files ?? [])]);
    };
    window.addEventListener('dragover', over);
    window.addEventListener('dragleave', leave);
    window.addEventListener('drop', drop);
    return () => {
      window.removeEventListener('dragover', over);
      window.removeEventListener('dragleave', leave);
      window.removeEventListener('drop', drop);
    };
  }, []);
  if (!isOver.value) return null;
  return (
    <div class="mesh-drop" role="status">
      {app.part.value === 'robot' ? 'Drop a mesh here: it becomes a module of the robot.' : 'Drop a mesh here: it becomes an object of the world.'}
    </div>
  );
}

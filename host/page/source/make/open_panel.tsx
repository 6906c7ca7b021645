// What can be opened: the scenarios of the project, those that were opened before, and those that ship with Proleg.
import { useSignal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import type { GalleryEntry } from '../wire/messages.js';
import { Picture } from './gallery_picture.js';
import type { MakeApp } from './make_app.js';
import { algorithmTitle } from '../state/robot_text.js';
import { shortPath } from './short_path.js';

function distanceText(distance: number): string {
  return `${distance.toFixed(distance < 10 ? 2 : 1)} m in 10 s`;
}

function factsOf({ joints, algorithms, distance }: GalleryEntry): string[] {
  const facts = algorithms.map(algorithmTitle);
  if (joints !== null) facts.unshift(joints === 1 ? '1 joint' : `${joints} joints`);
  if (distance !== null) facts.push(distanceText(distance));
  return facts;
}

function pictureText({ joints, distance, picture }: GalleryEntry): string {
  const robot = joints === null ? 'The robot' : `The robot with ${joints} joints`;
  const way = distance === null ? ' at its start' : distance < 0.1 ? ', which moves little in 10 s' : ` and its way of ${distanceText(distance)}`;
  return `${robot}${way}, ${picture?.view === 'above' ? 'from above' : 'from the side'}`;
}

function matches(entry: GalleryEntry, words: readonly string[]): boolean {
  const text = `${entry.title} ${entry.text} ${entry.folder} ${entry.file} ${factsOf(entry).join(' ')}`.toLowerCase();
  return words.every((word) => text.includes(word));
}

function failureText({ failure, missing }: GalleryEntry): string {
  return missing.length === 0 ? (failure ?? '') : `Needs ${missing.length === 1 ? 'the algorithm' : 'the algorithms'} ${missing.join(', ')}, not loaded.`;
}

function EntryButton({ entry, id, obstacle, open }: { entry: GalleryEntry; id: string; obstacle: string | null; open(): void }) {
  const facts = factsOf(entry);
  return (
    <button
      type="button"
      class="gallery-entry"
      aria-labelledby={`${id}-title`}
      aria-describedby={`${id}-picture ${id}-text`}
      aria-disabled={obstacle !== null}
      title={obstacle ?? entry.file}
      onClick={() => {
        if (obstacle === null) open();
      }}
    >
      {entry.picture !== null ? (
        <Picture picture={entry.picture} label={pictureText(entry)} id={`${id}-picture`} />
      ) : (
        entry.failure === null && (
          <span class="gallery-picture none" id={`${id}-picture`}>
            computing …
          </span>
        )
      )}
      <strong id={`${id}-title`}>{entry.title}</strong>
      <span class="gallery-text" id={`${id}-text`}>
        {entry.failure === null && entry.text !== '' && <span>{entry.text}</span>}
        {entry.failure !== null && <span class="problem">{failureText(entry)}</span>}
        {facts.length > 0 && (
          <span class="gallery-facts">
            {facts.map((fact) => (
              <span key={fact}>{fact}</span>
            ))}
          </span>
        )}
        <span class="hint">{shortPath(entry.file)}</span>
      </span>
    </button>
  );
}

// The entries of a list, by their headings, in the order in which these come.
function groupsOf(entries: readonly GalleryEntry[]): [string, GalleryEntry[]][] {
  const groups = new Map<string, GalleryEntry[]>();
  for (const entry of entries) groups.set(entry.folder, [...(groups.get(entry.folder) ?? []), entry]);
  return [...groups];
}

export function OpenPanel({ app }: { app: MakeApp }) {
  const wanted = useSignal('');
  const find = useRef<HTMLInputElement>(null);
  const isConnected = app.page.state.isConnected.value;
  useLayoutEffect(() => find.current?.focus(), []);
  useEffect(() => {
    if (isConnected) void app.page.operations.tell('gallery.look', {});
  }, [isConnected]);
  const entries = app.page.state.gallery.value?.entries ?? null;
  const obstacle = app.obstacle();
  const found = (entries ?? []).filter((entry) => matches(entry, wanted.value.toLowerCase().split(/\s+/).filter(Boolean)));
  const count = found.length === 1 ? '1 scenario' : `${found.length} scenarios`;
  return (
    <section class="panel make-panel open-panel" aria-label="Open" data-testid="open-panel">
      <div class="fields">
        <h2>Open</h2>
        <label>
          Find{' '}
          <input ref={find} type="search" value={wanted.value} onInput={(event) => (wanted.value = event.currentTarget.value)} />
        </label>
        <span class="hint" role="status">
          {entries === null ? 'Reading the folders …' : found.length === 0 ? 'Nothing has these words.' : count}
        </span>
        {obstacle !== null && <span class="hint">{obstacle}</span>}
      </div>
      {groupsOf(found).map(([folder, group]) => (
        <section key={folder} aria-label={folder}>
          <h3>{folder}</h3>
          <ul class="gallery">
            {group.map((entry) => (
              <li key={entry.file}>
                <EntryButton
                  entry={entry}
                  id={`gallery-${(entries ?? []).indexOf(entry)}`}
                  obstacle={obstacle}
                  open={() => void app.open(entry.file)}
                />
                {entry.failure === null && app.draft.value !== null && (
                  <span class="fields take">
                    <button
                      type="button"
                      aria-label={`Use the world of ${entry.title}`}
                      disabled={obstacle !== null}
                      title={obstacle ?? 'Your robot, in the world of this scenario'}
                      onClick={() => void app.take(entry.file, ['environment'])}
                    >
                      its world
                    </button>
                    <button
                      type="button"
                      aria-label={`Use the robot and the gait of ${entry.title}`}
                      disabled={obstacle !== null}
                      title={obstacle ?? 'The robot of this scenario, in your world'}
                      onClick={() => void app.take(entry.file, ['robot', 'actuation'])}
                    >
                      its robot and gait
                    </button>
                  </span>
                )}
              </li>
            ))}
          </ul>
        </section>
      ))}
    </section>
  );
}

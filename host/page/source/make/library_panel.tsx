// The library of objects: an item, its numbers, Add.
import { useSignal } from '@preact/signals';
import type { LibraryItem } from '../wire/messages.js';
import type { MakeApp } from './make_app.js';
import { WorldMeshForm } from './mesh_form.js';
import { NumberField } from './fields/number_field.js';

function ItemForm({ app, item, done }: { app: MakeApp; item: LibraryItem; done(): void }) {
  const values = useSignal<Record<string, number>>({});
  const problem = useSignal<string | null>(null);
  const obstacle = app.obstacle();
  const add = async () => {
    problem.value = await app.add(item.name, values.value);
    if (problem.peek() === null) done();
  };
  return (
    <form
      class="item-form"
      aria-label={`New ${item.name}`}
      onSubmit={(event) => {
        event.preventDefault();
        void add();
      }}
    >
      <p class="hint">{item.help}</p>
      <div class="fields">
        {item.parameters.map((parameter) => (
          <NumberField
            key={parameter.name}
            label={parameter.name}
            unit={parameter.unit === 'degree' ? '°' : parameter.unit}
            title={parameter.help}
            value={values.value[parameter.name] ?? parameter.usual}
            commit={(value) => {
              if (value < parameter.lowest || value > parameter.highest || (parameter.whole && !Number.isInteger(value))) {
                return `found ${value}, expected ${parameter.whole ? 'a whole number ' : ''}from ${parameter.lowest} to ${parameter.highest}`;
              }
              values.value = { ...values.value, [parameter.name]: value };
              return null;
            }}
          />
        ))}
      </div>
      <button type="submit" class="primary" disabled={obstacle !== null} title={obstacle ?? 'It comes in front of the robot.'}>
        Add {item.name}
      </button>
      {problem.value !== null && (
        <p class="problem" role="alert">
          {problem.value}
        </p>
      )}
    </form>
  );
}

export function LibraryPanel({ app }: { app: MakeApp }) {
  const chosen = useSignal<string | null>(null);
  const library = app.page.state.library.value;
  const item = library.find(({ name }) => name === chosen.value);
  const isMesh = app.mesh.isOpen.value && app.mesh.purpose.value === 'world';
  // The answer may come after another object was chosen.
  const close = (name: string) => {
    if (chosen.peek() === name) chosen.value = null;
  };
  return (
    <section class="panel make-panel" aria-label="Library">
      <div class="panel-head">
        <h2>Add</h2>
        {library.map(({ name, help }) => (
          <button
            key={name}
            type="button"
            title={help}
            aria-pressed={!isMesh && chosen.value === name}
            onClick={() => {
              chosen.value = !isMesh && chosen.value === name ? null : name;
              app.mesh.close();
            }}
          >
            {name}
          </button>
        ))}
        <button
          type="button"
          title="A shape of your own, from a file"
          aria-pressed={isMesh}
          onClick={() => (isMesh ? app.mesh.close() : app.mesh.open('world'))}
        >
          Mesh …
        </button>
      </div>
      {isMesh && <WorldMeshForm app={app} />}
      {!isMesh && item !== undefined && <ItemForm key={item.name} app={app} item={item} done={() => close(item.name)} />}
    </section>
  );
}

// A mesh of one's own: the file, how long its unit is, how it stands.
import { useRef } from 'preact/hooks';
import type { SentMesh } from '../wire/messages.js';
import { fromHex, toHex } from './colour_text.js';
import { formatNumber } from '../state/parameter_values.js';
import type { MakeApp } from './make_app.js';
import { NumberField } from './fields/number_field.js';
import { TextField } from './fields/text_field.js';
import { MeshPreview } from './mesh_preview.js';
import { sidesOf, sizeText, suggestedUnit, turnedSides, units, type Purpose } from './mesh_scale.js';

const endings = '.stl,.obj,.mtl,.dae,.off';

export function MeshFileButton({ app, purpose }: { app: MakeApp; purpose: Purpose }) {
  const input = useRef<HTMLInputElement>(null);
  const obstacle = app.obstacle();
  return (
    <>
      <button type="button" disabled={obstacle !== null} title={obstacle ?? 'STL, OBJ with its .mtl file, COLLADA or OFF'} onClick={() => input.current?.click()}>
        Choose a file …
      </button>
      <input
        ref={input}
        type="file"
        hidden
        multiple
        accept={endings}
        data-testid="mesh-file"
        onChange={(event) => {
          const files = [...(event.currentTarget.files ?? [])];
          event.currentTarget.value = ''; // the same file can be chosen again
          if (files.length > 0) void app.mesh.take(files, purpose);
        }}
      />
    </>
  );
}

// Which unit the file has.
function ScaleQuestion({ app, mesh }: { app: MakeApp; mesh: SentMesh }) {
  const own = app.mesh;
  const factor = own.factor.value;
  const suggested = suggestedUnit(mesh, own.purpose.value)?.name;
  const sides = (metres: number) => sizeText(sidesOf(mesh, metres));
  return (
    <fieldset class="mesh-units">
      <legend>A file does not say its unit. Which one is it?</legend>
      {units.map(({ name, metres }) => (
        <button key={name} type="button" aria-pressed={factor === metres} onClick={() => (own.factor.value = metres)}>
          {name}: {sides(metres)}
          {name === suggested ? ' (likely)' : ''}
        </button>
      ))}
      <NumberField
        label="or one unit is"
        unit="m"
        decimals={7}
        value={factor ?? 0}
        title="How many metres one unit of the file is"
        commit={(value) => {
          if (!(value > 0)) return `found ${value}, expected a number above 0`;
          own.factor.value = value;
          return null;
        }}
      />
      {factor !== null && !units.some(({ metres }) => metres === factor) && <span class="hint">{sides(factor)}</span>}
    </fieldset>
  );
}

function TurnButtons({ app }: { app: MakeApp }) {
  const { quarters } = app.mesh;
  return (
    <div class="fields" role="group" aria-label="Turn the mesh">
      {(['x', 'y', 'z'] as const).map((axis, i) => (
        <button
          key={axis}
          type="button"
          title={`Turns it by 90° about ${axis}`}
          onClick={() => (quarters.value = quarters.value.map((turns, at) => (at === i ? (turns + 1) % 4 : turns)) as [number, number, number])}
        >
          turn about {axis}: {90 * (quarters.value[i] as number)}°
        </button>
      ))}
    </div>
  );
}

const axisTexts = { world: ['x', 'ahead', 'up'], module: ['x', 'to the head', 'up'] } as const;

// What all meshes of one's own have: size, turn, colour, picture.
export function MeshNumbers({ app, mesh }: { app: MakeApp; mesh: SentMesh }) {
  const own = app.mesh;
  const { factor, quarters, colour, shape } = own;
  return (
    <>
      <p class="hint">
        <strong>{mesh.name}</strong>: {mesh.triangles} triangles
        {mesh.files.length > 1 ? `, with ${mesh.files.slice(1).join(', ')}` : ''}
      </p>
      <ScaleQuestion app={app} mesh={mesh} />
      {shape.value !== null && (
        <MeshPreview shape={shape.value} lowest={mesh.lowest} highest={mesh.highest} quarters={quarters.value} colour={colour.value} axisTexts={axisTexts[own.purpose.value]} />
      )}
      <TurnButtons app={app} />
      {factor.value !== null && (
        <p class="hint" data-testid="mesh-size">
          It is {sizeText(turnedSides(sidesOf(mesh, factor.value), quarters.value))} then: to the right, along the robot, up.
        </p>
      )}
      <label class="number-field">
        <span>colour</span>
        <input
          type="color"
          value={toHex(colour.value)}
          disabled={mesh.has_colours}
          title={mesh.has_colours ? 'The file has colours.' : ''}
          onChange={(event) => (colour.value = fromHex(event.currentTarget.value))}
        />
      </label>
    </>
  );
}

// The state of a mesh that is not there yet.
export function MeshProgress({ app }: { app: MakeApp }) {
  const state = app.mesh.state.value;
  if (state.phase === 'refused') {
    return (
      <p class="problem" role="alert">
        {state.reason}
      </p>
    );
  }
  if (state.phase !== 'sending') return null;
  return (
    <p role="status">
      {state.share < 1 ? `${state.name}: ${formatNumber(100 * state.share, 0)} % sent` : `${state.name}: being read …`}{' '}
      <button type="button" onClick={() => app.mesh.close()}>
        Cancel
      </button>
    </p>
  );
}

// Which links become the module.
function LinkButtons({ app }: { app: MakeApp }) {
  const links = app.draft.value?.robot.links ?? [];
  const chosen = app.mesh.links;
  const toggle = (link: number) => {
    const others = (chosen.value ?? []).filter((other) => other !== link);
    const next = others.length === (chosen.value ?? []).length ? [...others, link] : others;
    chosen.value = next.length === 0 ? null : next;
  };
  const order = links.map((_, i) => links.length - 1 - i); // from the tail, as the table
  return (
    <div class="fields" role="group" aria-label="Links">
      <button type="button" aria-pressed={chosen.value === null} onClick={() => (chosen.value = null)}>
        all links
      </button>
      {order.map((link) => (
        <button key={link} type="button" aria-pressed={chosen.value?.includes(link) === true} onClick={() => toggle(link)}>
          {links[link]!.name}
        </button>
      ))}
    </div>
  );
}

function ModuleNumbers({ app }: { app: MakeApp }) {
  const own = app.mesh;
  const module = own.module.value;
  if (module === null) return null;
  const above0 = (set: (value: number) => void) => (value: number) => {
    if (!(value > 0)) return `found ${value}, expected a number above 0`;
    set(value);
    return null;
  };
  return (
    <div class="fields">
      <TextField label="name of the module" value={module.name} commit={(name) => ((own.name.value = name), null)} />
      <NumberField
        label="from joint to joint"
        unit="m"
        decimals={5}
        value={module.length}
        title="The joints are so far apart; the mesh is in the middle. Suggested: the length of the mesh."
        commit={above0((value) => (own.length.value = value))}
      />
      <NumberField
        label="mass"
        unit="kg"
        decimals={5}
        value={module.mass}
        title="Of each module. Suggested: 500 kg/m³, about that of a module of the shipped caterpillar."
        commit={above0((value) => (own.mass.value = value))}
      />
    </div>
  );
}

// What makes the mesh a part of the draft, or gives it up; and why the program has refused it.
function UseButtons({ app, label, obstacle, hint, use }: { app: MakeApp; label: string; obstacle: string | null; hint: string; use(): Promise<unknown> }) {
  const own = app.mesh;
  return (
    <>
      <div class="fields">
        <button type="button" class="primary" onClick={() => void use()} disabled={obstacle !== null} title={obstacle ?? hint}>
          {label}
        </button>
        <button type="button" onClick={() => own.close()}>
          Cancel
        </button>
      </div>
      {own.problem.value !== null && (
        <p class="problem" role="alert">
          {own.problem.value}
        </p>
      )}
    </>
  );
}

function useText(links: readonly number[] | null): string {
  if (links === null) return 'Use it for all links';
  return links.length === 1 ? 'Use it for 1 link' : `Use it for ${links.length} links`;
}

export function ModuleMeshForm({ app }: { app: MakeApp }) {
  const own = app.mesh;
  const mesh = own.mesh.value;
  const obstacle = app.obstacle() ?? (own.factor.value === null ? 'Choose the unit first.' : null);
  return (
    <div class="item-form" role="form" aria-label="Module of my own">
      <p class="hint">
        A link with a shape of your own: an STL, OBJ (with its .mtl), COLLADA or OFF file, dropped on this page or chosen. It touches with the convex hull of the
        mesh. Joints keep their axes, servos and gait.
      </p>
      <LinkButtons app={app} />
      <div class="fields">
        <MeshFileButton app={app} purpose="module" />
      </div>
      <MeshProgress app={app} />
      {mesh !== null && (
        <>
          <MeshNumbers app={app} mesh={mesh} />
          <ModuleNumbers app={app} />
          <UseButtons app={app} label={useText(own.links.value)} obstacle={obstacle} hint="Undo brings the old modules back." use={() => own.makeModule()} />
        </>
      )}
    </div>
  );
}

export function WorldMeshForm({ app }: { app: MakeApp }) {
  const own = app.mesh;
  const mesh = own.mesh.value;
  const obstacle = app.obstacle() ?? (own.factor.value === null ? 'Choose the unit first.' : mesh?.gap != null && !own.isSheet.value ? 'Its surface is not closed.' : null);
  return (
    <div class="item-form" role="form" aria-label="New mesh">
      <p class="hint">
        A shape of your own: an STL, OBJ (with its .mtl), COLLADA or OFF file, dropped anywhere on this page or chosen. It stands still and touches with all its
        triangles. All meshes of a draft together have at most 80,000.
      </p>
      <div class="fields">
        <MeshFileButton app={app} purpose="world" />
      </div>
      <MeshProgress app={app} />
      {mesh !== null && (
        <>
          <MeshNumbers app={app} mesh={mesh} />
          {mesh.gap !== null && (
            <>
              <p class="problem" role="alert">
                {mesh.name}: found {mesh.gap}, expected a closed surface
              </p>
              <label class="switch">
                <input
                  type="checkbox"
                  checked={own.isSheet.value}
                  onChange={(event) => (own.isSheet.value = event.currentTarget.checked)}
                  onKeyDown={(event) => {
                    if (event.key === 'Enter') own.isSheet.value = !own.isSheet.value; // Space is STOP
                  }}
                />
                it is a sheet, which touches only from the side that its triangles face
              </label>
            </>
          )}
          <UseButtons app={app} label={`Add ${mesh.name}`} obstacle={obstacle} hint="It comes in front of the robot." use={() => own.add()} />
        </>
      )}
    </div>
  );
}

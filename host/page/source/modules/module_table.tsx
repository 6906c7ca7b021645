// The modules on the bus, as they are now.
import { currentState } from '../state/module_text.js';
import { CheckBox, JobButton, TableFrame } from './job_controls.js';
import { isRunning } from './job_text.js';
import { hasFreshModules, serialText, type ModuleRow } from './module_rows.js';
import type { ModulesApp } from './modules_app.js';
import { driveText, measured, stateText, troubleOf } from './row_text.js';
import { TouchDots } from './touch_dots.js';

function Row({ app, row }: { app: ModulesApp; row: ModuleRow }) {
  const { node, live, found, joint } = row;
  const isChosen = app.chosenNode.value === node;
  const trouble = troubleOf(row);
  const current = currentState(live?.current ?? null, live?.current_limit ?? null);
  return (
    <tr
      class={`${isChosen ? 'chosen' : ''} ${live?.silent === true ? 'silent' : ''}`}
      data-node={node}
      onClick={(event) => {
        if (event.target instanceof Element && event.target.closest('button, input, label') === null) app.choose(node);
      }}
    >
      <td>
        <CheckBox label={`Check node ${node}`} isHidden isOn={app.checkedNodes.value.has(node)} change={(isOn) => app.check(node, isOn)} />
      </td>
      <th scope="row">
        <button type="button" aria-pressed={isChosen} title="Shows its objects" onClick={() => app.choose(isChosen ? null : node)}>
          {node}
        </button>
      </th>
      <td class="code-text">{serialText(row.serial)}</td>
      <td>{joint?.name ?? '–'}</td>
      <td>{stateText(row)}</td>
      <td>{driveText(row)}</td>
      <td class="number">{measured(live?.angle, 1)}</td>
      <td class={`number ${current.tone}`}>{current.text}</td>
      <td class="number">{measured(live?.temperature, 0)}</td>
      <td>
        <TouchDots row={row} />
      </td>
      <td class={`text ${trouble === null ? '' : 'module bad'}`}>{trouble?.text ?? ''}</td>
      <td class="text" title={found?.name ?? ''}>
        {[found?.hardware, found?.software].filter(Boolean).join('; ') || '–'}
      </td>
    </tr>
  );
}

const titles = ['node', 'serial number', 'joint', 'state', 'drive', 'angle °', 'current mA', '°C', 'touch', 'errors', 'program'];
const numeric = new Set(['angle °', 'current mA', '°C']);

// What is to be done before anything else.
function Announcements({ app }: { app: ModulesApp }) {
  const modules = app.modules.value;
  const duplicates = modules?.found?.duplicate_node_ids ?? [];
  const troubled = app.rows.value.flatMap((row) => {
    const trouble = troubleOf(row);
    return trouble === null ? [] : [{ node: row.node, ...trouble }];
  });
  return (
    <>
      {modules !== null && hasFreshModules(modules) && (
        <p class="announcement" role="status" data-testid="fresh-modules">
          <span>
            <strong>There are modules without a node id.</strong> They come so from the factory. Places gives each its place in a robot, Recover only a free node id.
          </span>
          <button type="button" onClick={() => app.show('places')}>
            Places
          </button>
          <button type="button" onClick={() => app.show('recover')}>
            Recover
          </button>
        </p>
      )}
      {duplicates.length > 0 && (
        <p class="announcement bad" role="alert">
          <span>
            <strong>Several modules have the node id {duplicates.join(', ')}.</strong> Recover gives all but one of them another one.
          </span>
          <button type="button" onClick={() => app.show('recover')}>
            Recover
          </button>
        </p>
      )}
      {troubled.length > 0 && (
        <ul class="troubles" aria-label="Modules with errors">
          {troubled.map(({ node, text, advice }) => (
            <li key={node}>
              <strong>
                node {node}: {text}.
              </strong>{' '}
              {advice}
            </li>
          ))}
        </ul>
      )}
    </>
  );
}

export function ModuleTable({ app }: { app: ModulesApp }) {
  const rows = app.rows.value;
  const found = app.modules.value?.found ?? null;
  const areAllChecked = rows.length > 0 && rows.every(({ node }) => app.checkedNodes.value.has(node));
  return (
    <section class="panel modules-panel" aria-label="Modules" data-testid="modules">
      <div class="panel-head">
        <h2>{rows.length === 1 ? '1 module' : `${rows.length} modules`}</h2>
        {app.modules.value?.robot != null && <span class="hint">joints of {app.modules.value.robot.name}, by node ids</span>}
        <span class="space" />
        <JobButton app={app} needsControl={false} title="Asks all nodes what they are. It only reads" run={() => void app.tell('modules.scan', {})}>
          Scan
        </JobButton>
      </div>
      {!isRunning(app.job.value) && <Announcements app={app} />}
      {rows.length === 0 ? (
        <p class="hint">{found === null ? 'Nothing was heard yet. Scan asks all nodes.' : 'No module answers. Look at power and cable, then scan again.'}</p>
      ) : (
        <TableFrame label="Table of modules">
          <table class="module-table">
            <thead>
              <tr>
                <th scope="col">
                  <CheckBox label="Check all modules" isHidden isOn={areAllChecked} change={(isOn) => (app.checkedNodes.value = new Set(isOn ? rows.map(({ node }) => node) : []))} />
                </th>
                {titles.map((title) => (
                  <th scope="col" key={title} class={numeric.has(title) ? 'number' : ''}>
                    {title}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              {rows.map((row) => (
                <Row key={row.node} app={app} row={row} />
              ))}
            </tbody>
          </table>
        </TableFrame>
      )}
    </section>
  );
}

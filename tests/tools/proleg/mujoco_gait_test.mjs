// Exported models in a MuJoCo that is not ours: the WebAssembly module of npm's @mujoco/mujoco compiles them, and the set-points of a
// recording move them about as far as in Proleg's engines.
//
// usage: node mujoco_gait_test.mjs SOURCE_DIR PROGRAM_DIR FOLDER_WITH_NODE_MODULES

import assert from 'node:assert';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

// An actuator of MuJoCo is no servo of Proleg: it has no greatest speed, and is a little slow under load. Measured with version 3.14:
// at most 2.5 % from ODE, and 16 % less with tail_fixed.
const TOLERANCE = 0.25;
const SCENARIOS = ['travelling_wave/uniform', 'travelling_wave/tail_fixed', 'robots/snake/robot', 'robots/cube_chain/robot',
  'robots/y1/robot', 'gaits/rolling', 'gaits/sidewinding', 'obstacle/plain'];

const [source, programs, modules] = process.argv.slice(2).map((path) => resolve(path));
const { default: load } = await import(pathToFileURL(join(modules, 'node_modules/@mujoco/mujoco/mujoco.js')).href);
const mujoco = await load();
const ACTUATOR = 19;  // mjOBJ_ACTUATOR

function proleg(program, ...words) {
  return execFileSync(join(programs, `proleg-${program}`), words, { encoding: 'utf8', maxBuffer: 2 ** 28, stdio: ['ignore', 'pipe', 'ignore'] });
}

/** The columns with set-points, in rad: by joint the value of each tick. */
function setpoints(table) {
  const [head, ...rows] = table.trimEnd().split('\n').map((line) => line.split('\t'));
  const prefix = 'setpoint_deg.';
  return new Map(head.map((name, column) => [name, column]).filter(([name]) => name.startsWith(prefix))
    .map(([name, column]) => [name.slice(prefix.length), rows.map((row) => (row[column] * Math.PI) / 180)]));
}

/** Horizontal distance of the centre of mass of the robot, body 1 with all below it. */
function displacement(text, gait, tick) {
  const model = mujoco.MjModel.from_xml_string(text);
  const data = new mujoco.MjData(model);
  mujoco.mj_resetDataKeyframe(model, data, 0);
  mujoco.mj_forward(model, data);
  const start = Array.from(data.subtree_com.slice(3, 5));
  const steps = Math.round(tick / model.opt.timestep);
  const joints = [...gait].map(([name, angles]) => ({ actuator: mujoco.mj_name2id(model, ACTUATOR, name), angles, last: 0 }));
  assert(joints.length > 0 && joints.every(({ actuator }) => actuator >= 0));
  for (let k = 0; k < joints[0].angles.length; ++k) {
    for (let step = 1; step <= steps; ++step) {
      for (const { actuator, angles, last } of joints) {
        data.ctrl[actuator] = last + ((angles[k] - last) * step) / steps;
      }
      mujoco.mj_step(model, data);
    }
    joints.forEach((joint) => { joint.last = joint.angles[k]; });
  }
  mujoco.mj_forward(model, data);
  const end = Array.from(data.subtree_com.slice(3, 5));
  return Math.hypot(end[0] - start[0], end[1] - start[1]);
}

const folder = mkdtempSync(join(tmpdir(), 'proleg-'));
try {
  for (const name of SCENARIOS) {
    const scenario = join(source, `sim/scenarios/${name}.simulation.xml`);
    const recording = join(folder, `${name.replaceAll('/', '_')}.proleg`);
    const ours = JSON.parse(proleg('simulate', scenario, '--seconds', '10', '--record', recording, '--json')).displacement_m;
    const model = join(folder, 'model.xml');
    proleg('export', scenario, '--mjcf', model);
    const theirs = displacement(readFileSync(model, 'utf8'), setpoints(proleg('export', recording, '--out', '-')), 0.01);
    console.log(`${name}: ${ours.toFixed(3)} m in ODE, ${theirs.toFixed(3)} m in MuJoCo (${((theirs / ours - 1) * 100).toFixed(1)} %)`);
    assert(Math.abs(theirs - ours) < TOLERANCE * ours, name);
  }
} finally {
  rmSync(folder, { recursive: true });
}

import assert from 'node:assert/strict';
import { describe, it } from 'node:test';
import { OrbitCamera } from '../../../../host/page/source/geometry/orbit_camera.js';

const distanceOf = (camera: OrbitCamera) =>
  Math.hypot(...camera.position.map((value, axis) => value - (camera.target[axis] as number)));

describe('the orbit camera', () => {
  it('keeps its distance when it turns', () => {
    const camera = new OrbitCamera();
    camera.distance = 2;
    camera.turn(100, 40);
    assert.ok(Math.abs(distanceOf(camera) - 2) < 1e-12);
  });

  it('never goes over the top', () => {
    const camera = new OrbitCamera();
    camera.turn(0, 1e6);
    assert.ok(camera.elevation < Math.PI / 2);
  });

  it('moves its target by what a drag covers on the screen', () => {
    const camera = new OrbitCamera();
    camera.azimuth = -Math.PI / 2;
    camera.elevation = 0;
    camera.distance = 1;
    // Seen along +y from 1 m, a screen of 90 degrees is 2 m high; right is +x.
    camera.pan(250, 0, 500, Math.PI / 2);
    camera.target.forEach((value, axis) => assert.ok(Math.abs(value - [-1, 0, 0][axis]!) < 1e-12, `found ${camera.target.join()}`));
  });

  it('zooms between limits', () => {
    const camera = new OrbitCamera();
    camera.zoom(1e9);
    assert.equal(camera.distance, 60);
    camera.zoom(1e-9);
    assert.equal(camera.distance, 0.05);
  });
});

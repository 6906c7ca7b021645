#pragma once

namespace proleg::sim::mujoco {

/// Replaces MuJoCo's function for two boxes that touch, for all models of this process: it drops contacts that no
/// position of the boxes allows. Where faces just meet, MuJoCo 2.2.2 sometimes also reports a contact that is as deep
/// as a whole box (its issue 3476), and throws a robot into the air.
void mend_box_collision();

}  // namespace proleg::sim::mujoco

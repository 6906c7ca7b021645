#pragma once

#include <string_view>

namespace proleg::sim {

/// Listing B.8 of the thesis with the tags that its printed text has lost. It has numbers that were never initialised,
/// a module that is declared and has no frame, 13 parts of which a type has 5 or 6, and 7 types of which 6 are named.
/// The frame of the robot is complete; its second one is left out.
inline constexpr std::string_view printed_data = R"(<dataroot>
  <header>
    <Global_Adaptive_Touch parts="5" types="4">
      <typenames>desired_angle realtime simtime stepcount</typenames>
    </Global_Adaptive_Touch>
    <PatternGenerator_sinusoidal parts="5" types="7">
      <typenames>Angle Time Phase_Difference Frequency realtime simtime
      stepcount</typenames>
    </PatternGenerator_sinusoidal>
    <tactile parts="12" types="7">
      <typenames>x-normals y-normals z-normals realtime simtime stepcount</typenames>
    </tactile>
    <robot_data parts="13" types="16">
      <typenames>speed x_pos y_pos z_pos alpha beta gamma potential_energy average_com_speed desired_joint_positions
      real_joint_positions servo_currents servo_speeds realtime simtime stepcount</typenames>
    </robot_data>
  </header>
  <round number="0">
    <Global_Adaptive_Touch>
      <frame index="0" realtime="1361368880613" simtime="30">
        <desired_angle>0 0 0 0 0</desired_angle>
      </frame>
      <frame index="1" realtime="1361368880632" simtime="61">
        <desired_angle>0 0 0 0 0</desired_angle>
      </frame>
    </Global_Adaptive_Touch>
    <PatternGenerator_sinusoidal>
      <frame index="0" realtime="1361368880613" simtime="30">
        <Angle>5.80648 -29.297 -7.10298 28.9827 8.38557</Angle>
        <Time>0.031 0.031 0.031 0.031 0.031</Time>
        <Phase_Difference>0 0 0 0 0</Phase_Difference>
        <Frequency>inf inf inf inf inf</Frequency>
      </frame>
      <frame index="1" realtime="1361368880632" simtime="61">
        <Angle>11.3934 -27.4934 -12.6101 26.9354 13.802</Angle>
        <Time>0.062 0.062 0.062 0.062 0.062</Time>
        <Phase_Difference>0 0 0 0 0</Phase_Difference>
        <Frequency>inf inf inf inf inf</Frequency>
      </frame>
    </PatternGenerator_sinusoidal>
    <tactile></tactile>
    <robot_data>
      <frame index="0" realtime="1361368880613" simtime="30">
        <speed>3.24042e-18 3.24042e-18 3.24042e-18 3.24042e-18 3.24042e-18 3.24042e-18</speed>
        <x_pos>5.00018 5.00018 5.00018 5.00018 5.00018 5.00018</x_pos>
        <y_pos>-1.86 -1.86 -1.86 -1.86 -1.86 -1.86</y_pos>
        <z_pos>-2.69615 -2.69615 -2.69615 -2.69615 -2.69615 -2.69615</z_pos>
        <alpha>0.706795 0.706795 0.706795 0.706795 0.706795 0.706795</alpha>
        <beta>0.0209787 0.0209787 0.0209787 0.0209787 0.0209787 0.0209787</beta>
        <gamma>-0.0209787 -0.0209787 -0.0209787 -0.0209787 -0.0209787 -0.0209787</gamma>
        <potential_energy>-0.0674037 -0.000114443 -0.000114443 -0.134807 -0.000114258</potential_energy>
        <average_com_speed>0 0 0 0 0 0</average_com_speed>
        <desired_joint_positions>1.58101e-322 1.36856e-321 6.15379e-313 6.15379e-313 6.93178e-310</desired_joint_positions>
        <real_joint_positions>32 0 37 0 1.66857e+09</real_joint_positions>
        <servo_currents>32 0 101 0 1.34227e+09</servo_currents>
        <servo_speeds>2.54029e+07 0 37 0 1.34228e+09</servo_speeds>
      </frame>
    </robot_data>
  </round>
</dataroot>
)";

}  // namespace proleg::sim

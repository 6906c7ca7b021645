# Writes the result key into a header: two programs with equal keys give equal results of a search. It is a hash of the
# sources that determine a result and of SETTINGS (compiler, flags, libraries). Does not touch a header that already has it.
# Called at every build with SOURCE_DIR, SETTINGS and OUTPUT.
set(rooms
  shared/fixed shared/gait shared/kernel shared/computer/text
  sim/robot sim/mesh sim/environment sim/scenario sim/physics sim/mujoco sim/ode sim/reduced sim/measure sim/loop
  sim/optimize/experiment sim/optimize/evaluation sim/optimize/method)
set(text "${SETTINGS}")
foreach(room IN LISTS rooms)
  file(GLOB_RECURSE sources RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${room}/*.cpp ${SOURCE_DIR}/${room}/*.hpp)
  list(SORT sources)
  foreach(source IN LISTS sources)
    file(SHA256 ${SOURCE_DIR}/${source} hash)
    string(APPEND text "\n${source} ${hash}")
  endforeach()
endforeach()
string(SHA256 key "${text}")
set(header "#define PROLEG_RESULT_KEY \"${key}\"\n")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${header}" @ONLY)

#pragma once

// What the vector table leads to.

extern "C" {

[[noreturn]] void reset_handler();  ///< start.cpp
void fault_handler();               ///< faults.cpp
void can1_tx_handler();             ///< hardware.cpp, as the interrupts below
void can1_rx0_handler();
void can1_sce_handler();
void tim5_handler();
void usart2_handler();

/// What runs when an interrupt has asked for it, at the lowest priority; and what runs first. Each program (main.cpp,
/// the drivers' tests) has its own.
void pend_sv_handler();
[[noreturn]] void run_program();

}  // extern "C"

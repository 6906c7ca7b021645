#pragma once

// The functions in the vector table.

extern "C" {

[[noreturn]] void reset_handler();  ///< defined in start.cpp
void fault_handler();               ///< defined in faults.cpp
void can1_tx_handler();             ///< defined in hardware.cpp, as are the interrupts below
void can1_rx0_handler();
void can1_sce_handler();
void tim5_handler();
void pvd_handler();
void usart2_handler();
void dma1_stream5_handler();
void dma1_stream6_handler();

/// The program at the lowest priority, which interrupts request, and the start. Each program (main.cpp, the tests of
/// the drivers) defines both.
void pend_sv_handler();
[[noreturn]] void run_program();

}  // extern "C"

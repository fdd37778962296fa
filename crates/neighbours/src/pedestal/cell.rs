//! The pedestal's devices in the simulated cell (CHOSEN: a real pedestal has its own, without these mailboxes).

use interfaces::device::{GripValves, MotorCommand, PedestalSensors};

use crate::layout::{Flag, I32, Spelled, U16, U32};

pub type Orders = (GripValves, MotorCommand);

crate::layout! {
    /// What the devices of the pedestal read.
    SensorsLayout: PedestalSensors = "a set of sensor words";
    "potentiometer"   (potentiometer)        U16,   "of the fingers, counts";
    "l-gage"          (strain_left)          U16,   "strain gage of the left finger, counts";
    "r-gage"          (strain_right)         U16,   "of the right finger, counts";
    "table-pot"       (table_potentiometer)  U16,   "potentiometer of the table, counts";
    "limit+"          (limit_plus)           Flag,  "1 at the + limit of the table";
    "limit-"          (limit_minus)          Flag,  "1 at its - limit";
    "order#-echo"     (motor_echo)           U32,   "number of the last order that the rotary table controller has taken";
    "turning"         (motor_moving)         Flag,  "1 while its motor turns";
    "counter"         (motor_counter)        I32,   "its step counter";
}

crate::layout! {
    /// Orders to valves and motor.
    OrdersLayout: Orders = "a set of orders";
    "valves"  (0.bits)    U16,          "command bits to the eight air valves of the hand";
    "order#"  (1.number)  U32,          "number of the order to the rotary table controller, 0 for none: a different \
         number is a new order";
    "order"   (1.order)   Spelled<12>,  "turn, set-counter, stop; blank for none";
    "steps"   (1.steps)   I32,          "";
}

//! The object that the robot carries (docs/design/recovery.md "Database"): when it becomes the carried object, and
//! what Task records of it when its command ends. No header names the rows.

use rcs_core::{Actions, Plain, Variables, decision_table};

use super::item::{Carrying, TaskOrigin};
use crate::{held::Held, task::plan::TaskVerb};

/// The orders of the command in the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TakeOrder {
    /// None, or only GET-ENDEFF: an earlier command took the held object.
    Before,
    /// The order to take the object, or a later one.
    Given,
}

/// The event after which CARRY is consulted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LoadEvent {
    /// The update of the command is sent.
    Update,
    /// The command is finished.
    Finish,
}

/// The change of the carried object in each tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum PickUp {
    /// No change.
    Keep,
    /// The recorded object becomes the carried object.
    Carry,
}

/// The change of the carried object when a command ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Carry {
    /// No change.
    Keep,
    /// The object is no longer carried.
    Drop,
    /// The object is carried, with the place and the serial number of the command.
    Note,
    /// The object is carried, with place and serial number of the command. An update follows wherever it is released.
    Follow,
    /// The object is at the place of the command and keeps its serial number. An update follows wherever it is
    /// released.
    KeepSerial,
    /// The object is carried with the serial number of the command, and keeps its place.
    KeepPlace,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct NotedObject {
    /// The orders of the command in the ledger.
    pub order: TakeOrder,
    /// The content of the gripper, compared with the recorded object.
    pub held: Held,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct EndedCommand {
    /// The event.
    pub occasion: LoadEvent,
    /// The command.
    pub verb: TaskVerb,
    /// The content of the gripper.
    pub held: Held,
    /// The place where the object was taken.
    pub origin: TaskOrigin,
    /// The object that the robot carried last.
    pub carrying: Carrying,
}

decision_table! {
    /// PICK-UP: the object that TAKE has recorded becomes the carried object when it is held, but not before the
    /// order to take it.
    pub PICK_UP: fn pick_up(self::NotedObject) -> self::PickUp {
        1: order: Given, held: Right  => Carry;
        2: otherwise                  => Keep;
    }
}

decision_table! {
    /// CARRY: the record of the object of a command when its update is sent, or when a MOVE or an ACQUIRE ends with
    /// the object in the gripper. Without an update a followed object keeps its serial number. An object that an
    /// ACQUIRE found in the gripper keeps the place where it was taken.
    pub CARRY: fn carry(self::EndedCommand) -> self::Carry {
        1: occasion: Update, held: Right                                          => Follow;
        2: occasion: Update                                                       => Drop;
        3: verb: Move | Acquire, held: Right, origin: Source, carrying: Followed  => KeepSerial;
        4: verb: Move | Acquire, held: Right, origin: Source                      => Note;
        5: verb: Move | Acquire, held: Right, carrying: Known | Other             => KeepPlace;
        6: otherwise                                                              => Keep;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noted_object_is_carried_only_if_held_after_the_order() {
        for &held in Held::ALL {
            for &order in TakeOrder::ALL {
                let carried = pick_up((), &NotedObject { order, held }).action == PickUp::Carry;
                assert_eq!(carried, held == Held::Right && order == TakeOrder::Given, "{held} {order}");
            }
        }
    }

    /// An update sets the number and the place of the object from the command.
    #[test]
    fn update_replaces_the_carried_object() {
        for &carrying in Carrying::ALL {
            for &held in Held::ALL {
                let load = EndedCommand {
                    occasion: LoadEvent::Update,
                    verb: TaskVerb::Transfer,
                    held,
                    origin: TaskOrigin::Source,
                    carrying,
                };
                let expected = if held == Held::Right { Carry::Follow } else { Carry::Drop };
                assert_eq!(carry((), &load).action, expected, "{held} {carrying}");
            }
        }
    }

    #[test]
    fn finished_command_without_its_object_in_the_gripper_changes_nothing() {
        for &verb in TaskVerb::ALL {
            for &held in Held::ALL {
                let load = EndedCommand {
                    occasion: LoadEvent::Finish,
                    verb,
                    held,
                    origin: TaskOrigin::Source,
                    carrying: Carrying::Known,
                };
                let takes = held == Held::Right && matches!(verb, TaskVerb::Move | TaskVerb::Acquire);
                assert_eq!(carry((), &load).action == Carry::Keep, !takes, "{verb} {held}");
            }
        }
    }

    #[test]
    fn followed_object_keeps_its_serial_number_and_an_acquired_one_its_place() {
        let load = |origin, carrying| {
            let (occasion, verb, held) = (LoadEvent::Finish, TaskVerb::Acquire, Held::Right);
            carry((), &EndedCommand { occasion, verb, held, origin, carrying }).action
        };
        assert_eq!(load(TaskOrigin::Source, Carrying::Followed), Carry::KeepSerial);
        assert_eq!(load(TaskOrigin::Source, Carrying::Known), Carry::Note);
        assert_eq!(load(TaskOrigin::Source, Carrying::Other), Carry::Note);
        assert_eq!(load(TaskOrigin::Elsewhere, Carrying::Followed), Carry::Keep);
        assert_eq!(load(TaskOrigin::Elsewhere, Carrying::Known), Carry::KeepPlace);
        assert_eq!(load(TaskOrigin::Elsewhere, Carrying::Other), Carry::KeepPlace);
    }
}

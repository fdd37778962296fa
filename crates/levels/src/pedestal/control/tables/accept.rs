use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a command that hand or table cannot execute is refused before anything moves, since half a PRE-GRIP
    /// would be worse than none.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1: asked: Before    => consult;
        2: verb: None       => Fail(UnknownCommand);
        3: angle: Unknown   => Fail(TableAngleUnknown);
        4: angle: Beyond    => Fail(TableLimit);
        5: opening: Beyond  => Fail(HandUnattainable);
        6: opening: Within  => consult;
    }
}

use rcs_core::decision_table;

decision_table! {
    /// POINT (VI.1.1): one point per tick. "Ready" is reported one point early: Prim's answer arrives two ticks
    /// later. While Prim is not active the robot is stopped at once. The report is then for a Prim that is stepped
    /// singly, whose next point releases one from the queue.
    pub POINT: fn point(enum PointStep, super::Situation) -> super::Action {
        /// The points of the queue are sent.
        Sending {
            1:  line: Down                                             => Nothing(Error);
            2:  line: Busy, prim: Still                                => Nothing(Executing);
            3:  line: Busy, prim: Live, queue: Empty | One             => Nothing(Ready);
            4:  line: Busy, prim: Live, queue: More                    => Nothing(Executing);
            5:  line: Free, queue: Empty                               => Repeat(Finished);
            6:  line: Free, prim: Still, queue: One                    => Repeat(Ready);
            7:  line: Free, prim: Still, queue: More                   => Repeat(Executing);
            8:  line: Free, prim: Live,  queue: One,  way: Sendable    => Advance(Ready);
            9:  line: Free, prim: Live,  queue: More, way: Sendable    => Advance(Executing);
            10: line: Free, prim: Live,  queue: One,  way: Unsendable  => Refuse(Ready);
            11: line: Free, prim: Live,  queue: More, way: Unsendable  => Refuse(Executing);
        }
    }
}

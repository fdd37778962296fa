use rcs_core::decision_table;

decision_table! {
    /// POSITION, OPEN-GRIP (VI.3.1): servo the fingers to `sposition`.
    pub POSITION: fn position(super::Step, super::Situation) -> super::Action {
        Start | Move {
            1: opening: VeryNarrow  => Open(Coarse)   -> Move;
            2: opening: Narrow      => Open(Medium)   -> Move;
            3: opening: BitNarrow   => Open(Fine)     -> Move;
            4: opening: Right       => Stop           -> Settle;
            5: opening: BitWide     => Close(Fine)    -> Move;
            6: opening: Wide        => Close(Medium)  -> Move;
            7: opening: VeryWide    => Close(Coarse)  -> Move;
        }
        Settle {
            8: opening: Right       => Finish;
            9: otherwise            => Stop           -> Move;
        }
    }
}

//! Every row of every table fires.

use super::*;

impl Bench {
    fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// One tick in which the answer to what was sent last does not come yet.
    fn tick_unanswered(&mut self) {
        let late = std::mem::take(&mut self.external.devices.link_rx);
        self.tick();
        self.external.devices.link_rx.extend(late.as_slice());
    }

    /// A link that has failed once, and answers again.
    fn fail_and_return(&mut self) {
        self.connected = false;
        self.ticks(4);
        self.connected = true;
        self.ticks(30);
        assert_eq!((self.report(), self.memory.t3i.status.link_running), (T3iReport::Error, true));
    }
}

#[test]
fn every_row_fires() {
    let mut fired = Coverage::default();
    // Before the first command: nothing, PAUSE of a link that does not run yet, then one that does.
    let mut bench = Bench::new();
    bench.external.devices.link_rx = LinkBytes::default();
    bench.tick();
    bench.point(&home());
    bench.tick();
    bench.ticks(8);
    bench.command(T3iVerb::None);
    bench.tick();
    bench.command(T3iVerb::Pause);
    bench.ticks(2);
    bench.tick_unanswered();
    bench.fail_and_return();
    bench.tick_unanswered();
    fired.append(&mut bench.rows);

    // RESTART that is answered, that is not, and that is after all.
    let mut bench = Bench::running();
    bench.tick_unanswered();
    bench.connected = false;
    bench.command(T3iVerb::Restart);
    bench.ticks(12);
    bench.connected = true;
    bench.ticks(30);
    bench.tick_unanswered();
    fired.append(&mut bench.rows);

    // Points: one, many, too far for a tick, without answers.
    let mut bench = Bench::running();
    bench.point(&beside(0.1));
    bench.ticks(2);
    bench.tick_unanswered();
    bench.tick();
    for unanswered in [true, false, false] {
        bench.point(&beside(5.0));
        if unanswered {
            bench.tick_unanswered();
        } else {
            bench.tick();
        }
    }
    bench.tick_unanswered();
    // Prim stands still: with many points in the queue, with one, and with none.
    for _ in 0..100 {
        if bench.report() == T3iReport::Finished {
            break;
        }
        bench.memory.prim.header.republished = true;
        bench.ticks(2);
        bench.tick_unanswered();
        bench.memory.prim.header.republished = false;
        bench.tick();
    }
    bench.memory.prim.header.republished = true;
    bench.ticks(2);
    bench.memory.prim.header.republished = false;
    // A gap, and what follows it; a failed link, and what is sent to it.
    bench.memory.prim.t3i.number += 1;
    bench.point(&beside(0.3));
    bench.tick();
    bench.tick_unanswered();
    bench.point(&beside(0.4));
    bench.tick();
    bench.command(T3iVerb::Pause);
    bench.tick();
    bench.fail_and_return();
    bench.point(&beside(0.3));
    bench.ticks(2);
    bench.connected = false;
    bench.ticks(6);
    // A restart of the process.
    bench.t3i = T3i::default();
    bench.ticks(2);
    fired.append(&mut bench.rows);

    // DTR goes off before anything was sent, and after; a robot that is elsewhere is repeated where it is,
    // and sent on.
    let mut bench = Bench::new();
    (bench.on, bench.external.devices.link_ready) = (false, false);
    bench.ticks(2);
    fired.append(&mut bench.rows);
    let mut bench = restarted(led(cut_off(true), 100));
    bench.point(&bench.robot_tool());
    bench.ticks(2);
    bench.on = false;
    bench.ticks(3);
    fired.append(&mut bench.rows);

    // No words on the way: to the only point, and to the first of two.
    let (mut bench, goal) = beside_the_end_of_the_words();
    bench.point(&goal);
    bench.tick();
    fired.append(&mut bench.rows);
    let (mut bench, goal) = beside_the_end_of_the_words();
    bench.point(&goal);
    bench.tick_unanswered();
    bench.point(&goal);
    bench.ticks(2);
    fired.append(&mut bench.rows);

    // The resolvers leave the path, and never come near a reported position.
    let mut bench = Bench::running();
    bench.ticks(2);
    let elsewhere = counts(&HOME_JOINTS.map(|joint| joint + 0.1));
    for _ in 0..80 {
        bench.external.devices.resolvers.counts = elsewhere;
        bench.tick();
        if bench.tick == Tick(40) {
            bench.command(T3iVerb::Restart);
        }
    }
    fired.append(&mut bench.rows);

    // Points are taken only while the link runs, and a link that is lost is a fault.
    assert_eq!(fired.missing(tables::TABLES), ["POINT 1"]);
}

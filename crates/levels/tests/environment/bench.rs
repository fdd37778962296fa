//! A process and its environment. The test is the commander.

use std::fmt::Debug;

use interfaces::{
    CommonMemory, ExternalInputs, Header, for_each_process,
    process::{Inputs, Process},
};
use rcs_core::{Plain, plain::Writer, tick::Tick};

use crate::{coverage, processes};

pub trait Buffers {
    type Outputs: Plain + Copy;

    fn outputs(memory: &mut CommonMemory) -> &mut Self::Outputs;
    fn header(outputs: &mut Self::Outputs) -> &mut Header;
    fn echo(outputs: &Self::Outputs) -> u32;
    /// The last command of the commander; 0 for Task, whose commander is not a process.
    fn number(memory: &mut CommonMemory) -> u32;
}

macro_rules! buffers {
    ($(
        #[doc = $doc:literal]
        $id:ident $text:literal {
            buffers: $field:ident, $outputs:ty;
            failure: $failure:ident;
            board: $board:literal;
            commander: $($commander:ident, $above:ident . $command:ident)?;
            reads: $reads:expr;
        }
    )+) => {
        $(
            impl Buffers for processes::$id {
                type Outputs = $outputs;

                fn outputs(memory: &mut CommonMemory) -> &mut $outputs {
                    &mut memory.$field
                }

                fn header(outputs: &mut $outputs) -> &mut Header {
                    &mut outputs.header
                }

                fn echo(outputs: &$outputs) -> u32 {
                    outputs.status.echo
                }

                fn number(_memory: &mut CommonMemory) -> u32 {
                    0 $(+ _memory.$above.$command.number)?
                }
            }
        )+
    };
}

for_each_process!(buffers);

pub trait Tested<Data>: Buffers + Process<Data, Outputs = <Self as Buffers>::Outputs> + Default {
    type Order: Copy;
    type End: Copy + Debug + PartialEq;
    /// Time limit of every command, ticks.
    const LONGEST: u64;

    fn order(memory: &mut CommonMemory, order: Self::Order, number: u32);
    /// The number of the last command, if no process commands this one.
    fn number_outside(_external: &ExternalInputs) -> u32 {
        0
    }
    fn end(outputs: &<Self as Buffers>::Outputs) -> Option<Self::End>;
    /// True while the process has suspended itself until a person continues.
    fn is_suspended(_outputs: &<Self as Buffers>::Outputs, _external: &ExternalInputs) -> bool {
        false
    }
    /// Assertions after each tick, about the outputs and the inputs from which they follow.
    fn check(_outputs: &<Self as Buffers>::Outputs, _memory: &CommonMemory, _external: &ExternalInputs) {}
}

pub trait World<P: Buffers> {
    /// Write the device words of this tick, and the neighbours' outputs of the previous tick.
    fn sense(&mut self, _tick: Tick, _memory: &mut CommonMemory, _external: &mut ExternalInputs) {}
    /// Neighbours read the outputs `before` and write their own; devices react to the outputs of this tick.
    fn act(
        &mut self,
        _tick: Tick,
        _before: &CommonMemory,
        _after: &mut CommonMemory,
        _external: &mut ExternalInputs,
    ) {
    }
}

#[derive(Clone)]
pub struct Bench<P, W, Data = ()> {
    pub process: P,
    pub memory: CommonMemory,
    pub external: ExternalInputs,
    pub world: W,
    pub data: Data,
    pub tick: Tick,
    pub held: bool,
}

impl<P: Tested<()>, W: World<P>> Bench<P, W> {
    pub fn before(world: W) -> Self {
        Self::with(world, ())
    }
}

impl<P: Tested<Data>, W: World<P>, Data> Bench<P, W, Data> {
    /// A bench before its first tick, with task data.
    pub fn with(world: W, data: Data) -> Self {
        Self {
            process: P::default(),
            memory: CommonMemory::default(),
            external: ExternalInputs::default(),
            world,
            data,
            tick: Tick::BEFORE_START,
            held: false,
        }
    }

    pub fn send(&mut self, order: P::Order) {
        let number = P::number(&mut self.memory) + 1;
        P::order(&mut self.memory, order, number);
    }

    pub fn outputs(&mut self) -> <P as Buffers>::Outputs {
        *P::outputs(&mut self.memory)
    }

    pub fn step(&mut self) -> <P as Buffers>::Outputs {
        self.tick = self.tick.next();
        self.world.sense(self.tick, &mut self.memory, &mut self.external);
        let (before, mut outputs) = (self.memory, self.outputs());
        if self.held || P::is_suspended(&outputs, &self.external) {
            let header = P::header(&mut outputs);
            (header.stamp, header.republished) = (self.tick, true);
        } else {
            let (memory, external, data) = (&before, &self.external, &self.data);
            self.process.step(&Inputs { tick: self.tick, memory, external, data }, &mut outputs);
            coverage::note(P::NAME, P::TABLES, P::header(&mut outputs));
            P::check(&outputs, &before, &self.external);
        }
        *P::outputs(&mut self.memory) = outputs;
        self.world.act(self.tick, &before, &mut self.memory, &mut self.external);
        outputs
    }

    pub fn wait(&mut self, ticks: u32) -> <P as Buffers>::Outputs {
        (0..ticks).for_each(|_| {
            self.step();
        });
        self.outputs()
    }

    pub fn finish(&mut self) -> P::End {
        for _ in 0..P::LONGEST {
            let outputs = self.step();
            let number = P::number(&mut self.memory) + P::number_outside(&self.external);
            assert_eq!(P::echo(&outputs), number);
            if let Some(end) = P::end(&outputs) {
                return end;
            }
        }
        panic!("no end at tick {}", self.tick);
    }

    pub fn until(&mut self, holds: impl Fn(&Self) -> bool) {
        let began = self.tick;
        while !holds(self) {
            assert!(
                self.tick.since(began) <= P::LONGEST,
                "the condition is still false at tick {}",
                self.tick
            );
            self.step();
        }
    }

    pub fn at_every_tick(mut self) -> impl Iterator<Item = Self>
    where
        Self: Clone,
    {
        std::iter::from_fn(move || {
            let executes = P::end(&self.step()).is_none();
            executes.then(|| self.clone())
        })
    }

    /// Interrupt a command at every tick, in each of some ways, and send it again; `judge` then finishes it. The result
    /// must not depend on the interrupted part.
    pub fn sent_again(
        &self,
        send: impl Fn(&mut Self),
        interruptions: &[fn(&mut Self)],
        mut judge: impl FnMut(&mut Self),
    ) where
        Self: Clone,
    {
        for interrupt in interruptions {
            let mut bench = self.clone();
            send(&mut bench);
            let mut ticks = 0;
            for mut copy in bench.at_every_tick() {
                interrupt(&mut copy);
                send(&mut copy);
                judge(&mut copy);
                ticks += 1;
            }
            assert!(ticks > 1, "the command ends at once");
        }
    }

    pub fn execute(&mut self, order: P::Order) -> P::End {
        self.send(order);
        self.finish()
    }

    pub fn sleep(&mut self, ticks: u32) {
        self.held = true;
        self.wait(ticks);
        self.held = false;
    }

    pub fn restart(&mut self) {
        self.process = P::default();
    }

    /// Restore the process from the bytes of its state.
    pub fn restore(&mut self)
    where
        P::State: Copy,
    {
        let state = *self.process.state();
        self.restart();
        self.process.restore(state);
    }

    pub fn image(&mut self) -> Vec<u8> {
        let mut bytes = vec![0; <<P as Buffers>::Outputs as Plain>::SIZE];
        P::outputs(&mut self.memory).encode(&mut Writer::new(&mut bytes));
        bytes
    }
}

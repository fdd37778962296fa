//! The listener for neighbours and operators in other processes.

use std::{
    io,
    os::unix::net::UnixStream,
    sync::mpsc::{Receiver, channel},
};

use sessions::network::{Endpoint, EndpointHandle, Listener, NetEvent, Operators, Role};

use crate::{
    config::{ClockKind, OperatorAccess, RunConfig},
    error::StartError,
    observer::Observer,
};

pub struct Network {
    pub handles: Vec<EndpointHandle>, // endpoints of the neighbours that may connect
    /// Operators, if they may connect, and the events of their connections.
    operators: Option<(Operators, Receiver<NetEvent>)>,
    _listener: Listener,
}

impl Network {
    /// Starts the listener. Fails if the options contradict each other, or the address cannot be used.
    pub fn start(
        config: &RunConfig,
        endpoints: &[&Endpoint],
        observer: &mut dyn Observer,
    ) -> Result<Option<Self>, StartError> {
        check(config)?;
        let Some(address) = &config.network else { return Ok(None) };
        let operators = (config.operator == OperatorAccess::Network).then(|| {
            let (sender, events) = channel();
            (Operators::new(sender), events)
        });
        let who = match (endpoints, &operators) {
            ([], _) => "operators",
            (_, None) => "neighbours",
            (_, Some(_)) => "neighbours and operators",
        };
        let entering = operators.as_ref().map(|(operators, _)| operators.clone());
        let listener = Listener::with_operators(address, endpoints.iter().copied(), entering)?;
        observer.message(&format!("{who} can connect at {address}"));
        let handles = endpoints.iter().map(|endpoint| endpoint.handle()).collect();
        Ok(Some(Self { handles, operators, _listener: listener }))
    }

    /// Admit operators, since the run has begun.
    pub fn let_operators_in(
        &self,
        enter: impl Fn(UnixStream, Vec<u8>) -> io::Result<()> + Send + Sync + 'static,
    ) {
        if let Some((operators, _)) = &self.operators {
            operators.open(enter);
        }
    }

    pub fn events(&self) -> impl Iterator<Item = NetEvent> {
        self.operators.iter().flat_map(|(_, events)| events.try_iter())
    }
}

fn check(config: &RunConfig) -> Result<(), StartError> {
    let for_operators = config.operator == OperatorAccess::Network;
    if config.outside.contains(&Role::Operator) {
        return Err(StartError::OperatorOutside);
    }
    if config.network.is_some() && config.outside.is_empty() && !for_operators {
        return Err(StartError::NobodyConnects);
    }
    let is_reached = config.network.is_some() || config.live.is_some();
    let can_be_operated = config.clock == ClockKind::Real && config.shared_memory;
    let has_operator = can_be_operated && config.operator != OperatorAccess::None;
    if config.stand_by && config.inputs.is_none() && !has_operator {
        return Err(StartError::StandBy);
    }
    if config.resume.is_some() && config.inputs.is_none() && config.clock == ClockKind::Real && !has_operator
    {
        return Err(StartError::ResumeStandBy);
    }
    if for_operators && !(is_reached && can_be_operated) {
        return Err(StartError::OperatorNetwork);
    }
    Ok(())
}

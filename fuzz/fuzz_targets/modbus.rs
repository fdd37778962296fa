//! Modbus TCP, both ends: any bytes as a request, and as the answer to it.

#![no_main]

use libfuzzer_sys::fuzz_target;
use modbus::{
    Client, Header, MOST_FRAME_BYTES, Request, Response, mbap,
    server::{self, Memory},
};

fuzz_target!(|data: &[u8]| {
    let [length, rest @ ..] = data else { return };
    let (asked, answered) = rest.split_at(rest.len().min(usize::from(*length)));
    let mut buffer = [0; MOST_FRAME_BYTES];
    if let Ok(Some(frame)) = mbap::first_frame(asked) {
        assert!(frame.len() <= MOST_FRAME_BYTES);
    }
    let (mut coils, mut holding) = ([false; 300], [0; 300]);
    let mut memory = Memory {
        coils: &mut coils,
        discrete_inputs: &[true; 300],
        holding_registers: &mut holding,
        input_registers: &[0xA5A5; 300],
    };
    if let Ok(length) = server::answer(asked, &mut memory, &mut buffer) {
        assert_eq!(mbap::needed(&buffer[..length]), Ok(length), "an answer is a frame");
    }
    // The client has a request of its own; both as frames and as bodies, since few frames are sound by chance.
    let bodies = [Header::split(asked).map_or(asked, |(_, body)| body), asked];
    for request in bodies.into_iter().filter_map(|body| Request::parse(body).ok()) {
        let mut client = Client::new(1);
        let length = client.request(&request, &mut buffer).expect("a request that was read is within the limits");
        let (_, body) = Header::split(&buffer[..length]).expect("a frame");
        assert_eq!(Request::parse(body), Ok(request));
        let _ = client.answer(&request, answered);
        if let Ok(response) = Response::parse(&request, answered) {
            let values = response.words().map_or(0, |words| words.iter().count())
                + response.bits().map_or(0, |bits| bits.iter().count());
            assert!(values <= 2000);
        }
    }
});

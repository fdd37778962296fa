//! A counting allocator shows that neither end allocates.

use modbus::{
    Client, MOST_FRAME_BYTES, Request, Words,
    request::Range,
    server::{self, Memory},
};
use os_io::alloc::{Counting, Section, allocations, is_installed};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn ten_thousand_exchanges_do_not_allocate() {
    let (mut coils, mut holding) = ([false; 64], [0; 64]);
    let mut memory = Memory {
        coils: &mut coils,
        discrete_inputs: &[true; 64],
        holding_registers: &mut holding,
        input_registers: &[7; 64],
    };
    let mut client = Client::new(1);
    let (mut asked, mut answered) = ([0; MOST_FRAME_BYTES], [0; MOST_FRAME_BYTES]);
    assert!(is_installed());
    let before = allocations();
    let section = Section::enter();
    let mut sum = 0;
    for number in 0..10_000_u16 {
        let read = Range { first: 0, count: 33 };
        let words = [number];
        let request = Request::ReadWriteRegisters { read, first: 32, words: Words::new(&words) };
        let length = client.request(&request, &mut asked).unwrap();
        let length = server::answer(&asked[..length], &mut memory, &mut answered).unwrap();
        let response = client.answer(&request, &answered[..length]).unwrap();
        sum += u64::from(response.words().and_then(|words| words.get(32)).unwrap());
        assert!(server::answer(&asked[..5], &mut memory, &mut answered).is_err());
    }
    drop(section);
    assert_eq!((allocations() - before, sum), (0, 49_995_000));
}

//! Logs as a whole: written by the recorder, read back, damaged, replayed. The log must have exactly the data of a
//! ladder without task data.

use std::{
    fs,
    io::{self, Cursor, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::{Ladder, LadderState};
use rcs_core::{Plain, name::Name16, plain::to_bytes, tick::Tick};
use record::{
    Attachment, CellFrame, CellModel, End, Epoch, Level, Link, Log, Lost, Options, Pace, ReadError,
    RecordError, Recorder, ReplayError, Setup, Timing, Transform, golden, replay, replay_with,
    sink::Sink,
    tap::{Channel, Tap},
    writer::{LogWriter, TickRecord},
};
use taskdata::{files::TaskData, load::Source};
use tempfile::TempDir;

struct Scratch(TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

fn setup() -> Setup {
    let text = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let link = |name: &str, parent: &str| Link { name: name.into(), parent: parent.into() };
    let table = (link("table", "world"), Transform { position: [1.0, 0.0, 0.5], ..Transform::IDENTITY });
    let urdf = "<robot name='cell'><link name='base'/><link name='arm'/><joint name='turn' type='revolute'>\
                <parent link=\"base\"/><child link=\"arm\"/></joint></robot>";
    Setup {
        epoch: Epoch::Fixed,
        run: [text("version", "0.0.1-test"), text("seed", "7")].into(),
        attachments: vec![Attachment::text(Attachment::JOB, "TRANSFER")],
        cell: Some(CellModel {
            urdf: urdf.into(),
            links: vec![link("base", "world"), link("arm", "base")],
            fixed: vec![table],
            joints: vec!["turn".into()],
            ..CellModel::default()
        }),
    }
}

fn inputs(tick: Tick) -> ExternalInputs {
    let mut external = ExternalInputs::default();
    let turn = u32::try_from(tick.0 * 37 % 131_072).unwrap();
    external.devices.resolvers.counts = [turn, 5 * turn % 131_072, 0, 0, 0, 1];
    external.devices.resolvers.valid = true;
    external.devices.joystick.velocity = 1000;
    external.hws.number = u32::try_from(tick.0 / 100).unwrap();
    external.hws.command = Name16::new(if tick.0 % 200 < 100 { "TRANSFER" } else { "PAUSE" }).unwrap();
    external.hws.object = Some(Name16::new("LINKBAR1").unwrap());
    external
}

fn run(ticks: u64, mut each: impl FnMut(Tick, &ExternalInputs, &CommonMemory, LadderState)) -> u64 {
    let mut ladder = Ladder::default();
    let mut digest = rcs_core::digest::Digest::new();
    let mut memory = CommonMemory::default();
    for tick in (1..=ticks).map(Tick) {
        let (before, external) = (memory, inputs(tick));
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        digest.add_record(&memory, &mut [0; CommonMemory::SIZE]);
        each(tick, &external, &memory, ladder.state());
    }
    digest.value()
}

fn cell_digest(tick: Tick) -> u64 {
    u64::MAX - tick.0
}

fn record_run(path: &Path, ticks: u64) -> record::Summary {
    let mut recorder = Recorder::start(path, Pace::Wait, setup()).unwrap();
    let digest = run(ticks, |tick, external, memory, state| {
        let turn = tick.0 as f64 * 1e-3;
        let arm = Transform { position: [0.0, 0.0, 1.0], rotation: [0.0, 0.0, turn.sin(), turn.cos()] };
        let frame = CellFrame::of(tick, [Transform::IDENTITY, arm], [2.0 * turn]);
        recorder.cell(&frame.with_digest(cell_digest(tick)));
        if tick.0 == 30 {
            recorder.note(tick, Level::Warning, "cell", "cell.slipped", "the part slips");
        }
        recorder.tick(tick, external, memory, || state);
    });
    recorder.finish(End { digest: Some(digest), result: "finished".into(), ..End::default() }).unwrap()
}

fn recorded(ticks: u64) -> (Scratch, PathBuf) {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    record_run(&path, ticks);
    (scratch, path)
}

#[test]
fn recorded_run_replays_bit_for_bit() {
    let scratch = Scratch::new();
    let path = scratch.file("deep/down/run.mcap");
    let summary = record_run(&path, 1000);
    assert_eq!((summary.ticks, summary.lost), (1000, Lost::default()));
    assert_eq!(summary.bytes, fs::metadata(&path).unwrap().len());

    let log = Log::open(&path).unwrap();
    assert!(log.complete);
    assert_eq!(log.run["seed"], "7");
    assert_eq!(log.end.as_ref().unwrap()["result"], "finished");
    assert_eq!(log.attachment(Attachment::JOB).unwrap().data, b"TRANSFER");
    let told = log.lines().find(|line| line.tick == Tick(30) && line.source == "cell");
    let told = told.map(|line| (line.code, line.text));
    assert_eq!(told, Some(("cell.slipped".to_owned(), "the part slips".to_owned())));
    let digests: Vec<(Tick, u64)> = log.cell_digests().collect();
    assert_eq!(digests, (1..=1000).map(|tick| (Tick(tick), cell_digest(Tick(tick)))).collect::<Vec<_>>());
    for (topic, messages) in
        [("/robot_description", 1), ("/tf_static", 1), ("/tf", 1000), ("/joint_states", 1000)]
    {
        assert_eq!(log.messages(topic).count(), messages, "{topic}");
    }
    let mut recorded = log.ticks();
    run(1000, |tick, external, memory, state| {
        let logged = recorded.next().unwrap().unwrap();
        assert_eq!(logged.tick, tick);
        assert_eq!(logged.external, to_bytes::<{ ExternalInputs::SIZE }, _>(external));
        assert_eq!(logged.memory, to_bytes::<{ CommonMemory::SIZE }, _>(memory));
        let expected = (tick.0 % 25 == 1).then(|| to_bytes::<{ LadderState::SIZE }, _>(&state).to_vec());
        assert_eq!(logged.state, expected);
    });
    assert!(recorded.next().is_none());

    let report = replay(&path).unwrap();
    assert!(report.is_same(), "{:?}", report.first_difference);
    assert_eq!((report.ticks, report.skipped), (1000, 0));
    assert_eq!(report.recorded_digest, Some(report.digest.value()));
}

#[test]
fn equal_runs_write_equal_bytes() {
    let scratch = Scratch::new();
    let (first, second) = (scratch.file("1.mcap"), scratch.file("2.mcap"));
    record_run(&first, 200);
    record_run(&second, 200);
    assert!(fs::read(first).unwrap() == fs::read(second).unwrap());
}

#[test]
fn truncated_log_is_read_up_to_its_end() {
    let (_scratch, path) = recorded(300);
    let whole = fs::read(&path).unwrap();
    let mut most = 0;
    for part in 1..=40 {
        let cut = whole.len() * part / 41;
        fs::write(&path, &whole[..cut]).unwrap();
        let Ok(log) = Log::open(&path) else {
            assert!(part < 10, "the head of the log is lost at {cut} of {} bytes", whole.len());
            continue;
        };
        assert!(!log.complete);
        let ticks = log.ticks().filter(Result::is_ok).count();
        assert!(ticks >= most, "{ticks} ticks up to byte {cut}, {most} before");
        most = ticks;
        if ticks > 0 {
            let report = replay(&path).unwrap();
            assert!(report.is_same() && !report.complete, "cut at {cut}: {:?}", report.first_difference);
        }
    }
    assert!(most > 225, "{most} ticks of 300 were readable");
}

#[test]
fn replay_channel_has_its_own_chunks() {
    let (_scratch, path) = recorded(300);
    let summary = mcap::Summary::read(&fs::read(&path).unwrap()).unwrap().unwrap();
    let replay = summary.channels.values().find(|channel| channel.topic == "/replay").unwrap().id;
    let chunks = summary.chunk_indexes.iter().map(|chunk| &chunk.message_index_offsets);
    let (own, others): (Vec<_>, Vec<_>) = chunks.partition(|channels| channels.contains_key(&replay));
    assert_eq!((own.len(), others.len()), (12, 12), "two for each second");
    assert!(own.iter().all(|channels| channels.len() == 1));
}

#[test]
fn changed_byte_is_reported_or_harmless() {
    let (_scratch, path) = recorded(300);
    let sound = fs::read(&path).unwrap();
    let mut untold = 0;
    for at in (0..sound.len()).step_by(sound.len() / 251) {
        let mut bytes = sound.clone();
        bytes[at] ^= 0x10;
        fs::write(&path, bytes).unwrap();
        let Ok(report) = replay(&path) else { continue };
        if report.damage.is_none() && report.complete {
            assert!(report.is_same(), "byte {at}: {:?}", report.first_difference);
            assert_eq!((report.ticks, report.skipped), (300, 0), "byte {at}");
            untold += 1;
        }
    }
    assert!(untold > 0, "an index that is wrong is not used");
}

fn written_again(log: &[u8], options: mcap::WriteOptions) -> Vec<u8> {
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    let summary = mcap::Summary::read(log).unwrap().unwrap();
    for index in &summary.metadata_indexes {
        writer.write_metadata(&mcap::read::metadata(log, index).unwrap()).unwrap();
    }
    for message in mcap::MessageStream::new(log).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

#[test]
fn log_rewritten_by_another_program_is_read_whole() {
    let (_scratch, path) = recorded(300);
    let recorded = fs::read(&path).unwrap();
    let new = mcap::WriteOptions::new;
    let read = |options: mcap::WriteOptions| {
        fs::write(&path, written_again(&recorded, options)).unwrap();
        let report = replay(&path).unwrap();
        assert!(report.is_same() && report.complete, "{:?}", report.first_difference);
        (report.ticks, report.skipped, report.damage.is_some())
    };
    for (number, options) in [
        new(),
        new().compression(None),
        new().chunk_size(Some(10_000)),
        new().repeat_channels(false),
        new().repeat_schemas(false).emit_chunk_indexes(false),
        new().emit_message_indexes(false),
        new().emit_summary_records(false),
        new().calculate_data_section_crc(false),
        new().calculate_summary_section_crc(false),
        new().calculate_chunk_crcs(false),
        new().use_chunks(false),
        new().chunk_size(Some(30_000_000)),
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(read(options), (300, 0, false), "options {number}");
    }
}

/// The log with each chunk compressed by LZ4, as other programs write it.
fn with_lz4(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write as _;
    let (mut out, mut at) = (bytes[..8].to_vec(), 8);
    while at + 9 <= bytes.len() && bytes[at..] != *mcap::MAGIC {
        let length = usize::try_from(u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap())).unwrap();
        let (opcode, body) = (bytes[at], &bytes[at + 9..at + 9 + length]);
        at += 9 + length;
        // Indexes and summary are omitted, because they depend on the size of the chunks.
        let body = match opcode {
            mcap::records::op::CHUNK => {
                let name = usize::try_from(u32::from_le_bytes(body[28..32].try_into().unwrap())).unwrap();
                assert_eq!(&body[32..32 + name], b"", "the records are not compressed");
                let mut packed = lz4_flex::frame::FrameEncoder::new(Vec::new());
                packed.write_all(&body[40 + name..]).unwrap();
                let packed = packed.finish().unwrap();
                let length = u64::try_from(packed.len()).unwrap().to_le_bytes();
                [&body[..28], &3_u32.to_le_bytes(), b"lz4", &length, &packed].concat()
            }
            mcap::records::op::HEADER | mcap::records::op::METADATA | mcap::records::op::ATTACHMENT => {
                body.to_vec()
            }
            _ => continue,
        };
        out.push(opcode);
        out.extend(u64::try_from(body.len()).unwrap().to_le_bytes());
        out.extend(body);
    }
    out
}

#[test]
fn chunks_in_lz4_are_read_and_other_compressions_are_named() {
    let (_scratch, path) = recorded(300);
    let recorded = fs::read(&path).unwrap();
    let plain =
        written_again(&recorded, mcap::WriteOptions::new().compression(None).chunk_size(Some(50_000)));
    let packed = with_lz4(&plain);
    fs::write(&path, &packed).unwrap();
    let report = replay(&path).unwrap();
    assert!(report.is_same() && report.damage.is_none(), "{:?}", report.damage);
    assert_eq!((report.ticks, report.skipped), (300, 0));
    // An unknown compression name of the same length.
    let place = packed.windows(3).position(|window| window == b"lz4").unwrap();
    let mut other = packed;
    other[place..place + 3].copy_from_slice(b"xyz");
    fs::write(&path, &other).unwrap();
    let damage = Log::open(&path).unwrap().damage().unwrap();
    assert!(damage.contains("compressed with \"xyz\", and only zstd, lz4 or no compression"), "{damage}");
}

#[test]
fn file_with_several_runs_is_refused() {
    let (_scratch, path) = recorded(10);
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).unwrap();
    for job in ["linkbar", "clevis"] {
        let metadata = [("job".to_owned(), job.to_owned())].into();
        writer.write_metadata(&mcap::records::Metadata { name: "rcs-run".into(), metadata }).unwrap();
    }
    writer.finish().unwrap();
    fs::write(&path, writer.into_inner().into_inner()).unwrap();
    assert!(matches!(Log::open(&path), Err(ReadError::Merged { .. })));
}

#[test]
fn unreadable_chunk_with_right_checksums_leaves_a_gap() {
    let (_scratch, path) = recorded(300);
    let recorded = fs::read(&path).unwrap();
    let expected: Vec<_> = Log::open(&path).unwrap().ticks().map(Result::unwrap).collect();
    let small = written_again(&recorded, mcap::WriteOptions::new().chunk_size(Some(5_000)));
    let summary = mcap::Summary::read(&small).unwrap().unwrap();
    let chunks = summary.chunk_indexes.len();
    let mut skipped = 0;
    for chunk in summary.chunk_indexes.iter().skip(chunks / 4).step_by(chunks / 40) {
        let mut bytes = small.clone();
        let chunk = usize::try_from(chunk.chunk_start_offset + chunk.chunk_length).unwrap();
        bytes[chunk - 20] ^= 0x10;
        // The checksum at the end of the data.
        let footer = bytes.len() - 37;
        let summary = u64::from_le_bytes(bytes[footer + 9..footer + 17].try_into().unwrap());
        let end = usize::try_from(summary).unwrap() - 13;
        let checksum = crc32fast::hash(&bytes[..end]);
        bytes[end + 9..end + 13].copy_from_slice(&checksum.to_le_bytes());
        fs::write(&path, bytes).unwrap();
        for logged in Log::open(&path).unwrap().ticks().map(Result::unwrap) {
            let recorded = &expected[usize::try_from(logged.tick.0).unwrap() - 1];
            assert!(logged.memory == recorded.memory && logged.external == recorded.external);
        }
        let report = replay(&path).unwrap();
        assert!(report.first_difference.is_none(), "{:?}", report.first_difference);
        skipped += report.skipped;
    }
    assert!(skipped > 0, "a chunk with ticks was among them");
}

#[derive(Clone, Default)]
struct Played(Arc<Mutex<(u64, u64)>>);

impl Tap for Played {
    fn channel(&mut self, _: u16, _: &Channel<'_>) {}

    fn message(&mut self, _: u16, time: u64, _: &[u8]) {
        let mut played = self.0.lock().unwrap();
        assert!(time >= played.1, "{time} after {}", played.1);
        *played = (played.0 + 1, time);
    }
}

#[test]
fn messages_are_played_in_time_order() {
    let (_scratch, path) = recorded(300);
    let mut tap = Played::default();
    Log::open(&path).unwrap().play(&mut tap, |_| {});
    let summary = mcap::Summary::read(&fs::read(&path).unwrap()).unwrap().unwrap();
    assert_eq!(tap.0.lock().unwrap().0, summary.stats.unwrap().message_count);
}

/// A log in memory. `change` modifies each tick before it is written, or returns false to omit the tick.
fn changed(ticks: u64, mut change: impl FnMut(&mut TickRecord) -> bool) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut log = LogWriter::create(&mut file, setup()).unwrap();
    let mut gap = 0;
    let digest = run(ticks, |tick, external, memory, state| {
        let mut record = TickRecord { tick, gap, external: *external, memory: *memory, timing: None };
        if change(&mut record) {
            let state = (gap > 0 || tick.0 % 25 == 1).then_some(state);
            log.tick(&record, state.as_ref(), None).unwrap();
            gap = 0;
        } else {
            gap += 1;
        }
    });
    log.finish(&End { digest: Some(digest), result: String::new(), ..End::default() }, Lost::default())
        .unwrap();
    file.into_inner()
}

#[test]
fn a_difference_is_named() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    let bytes = changed(100, |record| {
        if record.tick.0 == 42 {
            record.memory.prim.status.distance += 1;
        }
        true
    });
    fs::write(&path, bytes).unwrap();
    let report = replay(&path).unwrap();
    assert!(!report.is_same());
    let difference = report.first_difference.unwrap();
    assert_eq!(
        (difference.tick, difference.buffer.as_str(), difference.field.as_str()),
        (Tick(42), "prim.status", "distance")
    );
    assert_eq!(difference.was.parse::<i32>().unwrap(), difference.is.parse::<i32>().unwrap() + 1);
    assert!(difference.to_string().starts_with("tick 42, buffer prim.status, field distance: was "));
}

#[test]
fn unrecorded_input_causes_a_difference() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    let bytes = changed(300, |record| {
        if record.tick.0 >= 100 {
            record.external.hws.number = 0;
        }
        true
    });
    fs::write(&path, bytes).unwrap();
    let difference = replay(&path).unwrap().first_difference.unwrap();
    assert!(difference.tick >= Tick(100) && difference.tick < Tick(103), "{difference}");
}

#[test]
fn replay_continues_after_a_gap() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    fs::write(&path, changed(200, |record| !(60..=64).contains(&record.tick.0))).unwrap();
    let log = Log::open(&path).unwrap();
    let gaps: Vec<(Tick, u64)> = log
        .ticks()
        .map(Result::unwrap)
        .filter(|tick| tick.gap > 0)
        .map(|tick| (tick.tick, tick.gap))
        .collect();
    assert_eq!(gaps, [(Tick(65), 5)]);
    assert!(
        log.lines()
            .any(|line| line.tick == Tick(65) && line.text.starts_with("missing before this tick: 5 ticks"))
    );
    let report = replay(&path).unwrap();
    assert!(report.is_same(), "{:?}", report.first_difference);
    assert_eq!((report.ticks, report.skipped), (194, 6));
}

#[test]
fn log_of_another_layout_is_refused() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut file).unwrap();
    let text = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let metadata = [text("layout", "0123456789abcdef"), text("version", "9.9.9")].into();
    writer.write_metadata(&mcap::records::Metadata { name: "rcs-run".into(), metadata }).unwrap();
    writer.finish().unwrap();
    drop(writer);
    fs::write(&path, file.into_inner()).unwrap();
    let error = replay(&path).unwrap_err().to_string();
    assert!(error.contains("layout 0123456789abcdef") && error.contains("(version 9.9.9)"), "{error}");
}

#[test]
fn other_files_are_refused_as_logs() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    assert!(matches!(Log::open(&path), Err(ReadError::Unreadable { .. })));
    for bytes in [&b""[..], b"PK\x03\x04 this is not an MCAP file at all", &[0x89, b'M', b'C']] {
        fs::write(&path, bytes).unwrap();
        assert!(Log::open(&path).is_err_and(|error| error.to_string().contains("run.mcap")));
    }
    let mut file = Cursor::new(Vec::new());
    mcap::Writer::new(&mut file).unwrap().finish().unwrap();
    fs::write(&path, file.into_inner()).unwrap();
    assert!(matches!(Log::open(&path), Err(ReadError::NotALog { .. })));
}

struct Disk {
    bytes: Cursor<Vec<u8>>,
    left: usize,
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if bytes.len() > self.left {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.left -= bytes.len();
        self.bytes.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Disk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes.seek(to)
    }
}

#[test]
fn full_disk_ends_the_log_at_any_byte() {
    let needed = changed(60, |_| true).len();
    let mut failed = 0;
    for left in (0..needed).step_by(needed / 50) {
        let disk = Disk { bytes: Cursor::new(Vec::new()), left };
        let Ok(mut log) = LogWriter::create(disk, setup()) else {
            failed += 1;
            continue;
        };
        let mut result = Ok(());
        run(60, |tick, external, memory, state| {
            let record = TickRecord { tick, gap: 0, external: *external, memory: *memory, timing: None };
            if result.is_ok() {
                result = log.tick(&record, Some(&state), None);
            }
        });
        failed += usize::from(result.is_err() || log.finish(&End::default(), Lost::default()).is_err());
    }
    assert!(failed >= 50, "{failed} of 51 disks were too small");
}

#[test]
fn removed_log_does_not_end_the_run() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    let mut recorder = Recorder::start(&path, Pace::Wait, setup()).unwrap();
    let mut ticks = 0;
    run(2000, |tick, external, memory, state| {
        if tick.0 == 100 {
            fs::remove_file(&path).unwrap();
        }
        recorder.tick(tick, external, memory, || state);
        ticks += 1;
    });
    assert_eq!(ticks, 2000);
    assert!(recorder.lost().ticks > 0, "after its end the log takes no ticks");
    assert!(matches!(recorder.finish(End::default()), Err(RecordError::Removed { .. })));
}

#[test]
fn removed_directory_does_not_end_the_run() {
    let scratch = Scratch::new();
    let path = scratch.file("deep/down/run.mcap");
    let mut recorder = Recorder::start(&path, Pace::Wait, setup()).unwrap();
    let mut ticks = 0;
    run(1000, |tick, external, memory, state| {
        if tick.0 == 60 {
            fs::remove_dir_all(scratch.file("deep")).unwrap();
        }
        recorder.tick(tick, external, memory, || state);
        ticks += 1;
    });
    assert_eq!(ticks, 1000);
    let error = recorder.finish(End::default()).unwrap_err();
    assert!(error.to_string().contains("run.mcap was removed during the run"), "{error}");
}

/// `/dev/full` is always full, so not even the head of the log has room.
#[cfg(target_os = "linux")]
#[test]
fn full_disk_is_reported_before_the_run() {
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let error: RecordError = LogWriter::create(Sink::new(full, true), setup()).err().unwrap().into();
    assert!(error.to_string().contains("No space left on device"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn device_is_refused_as_a_log() {
    let error = Recorder::start(Path::new("/dev/full"), Pace::Drop, setup()).err().unwrap();
    assert!(error.to_string().ends_with("a regular file was expected, found a device"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn read_only_directory_is_reported_before_the_run() {
    // Even an administrator cannot create a directory here.
    let error = Recorder::start(Path::new("/proc/runs/run.mcap"), Pace::Drop, setup()).err().unwrap();
    assert!(error.to_string().starts_with("the log /proc/runs/run.mcap cannot be created: "), "{error}");
}

#[test]
fn times_and_cell_digest_are_logged() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    let mut recorder = Recorder::start(&path, Pace::Wait, setup()).unwrap();
    let digest = run(60, |tick, external, memory, state| {
        if tick.0 % 2 == 0 {
            recorder.timing(Timing { controller_ns: 1000 + tick.0, skipped: tick.0 / 10 });
        }
        if tick.0 % 25 == 1 {
            recorder.cell(&CellFrame::new(tick).with_digest(u64::MAX - tick.0));
        }
        recorder.tick(tick, external, memory, || state);
    });
    recorder.finish(End { digest: Some(digest), ..End::default() }).unwrap();
    for logged in Log::open(&path).unwrap().ticks().map(Result::unwrap) {
        let tick = logged.tick.0;
        let timing = (tick % 2 == 0).then_some(Timing { controller_ns: 1000 + tick, skipped: tick / 10 });
        assert_eq!(logged.timing, timing, "tick {tick}");
        assert_eq!(logged.world, (tick % 25 == 1).then_some(u64::MAX - tick), "tick {tick}");
    }
    assert!(replay(&path).unwrap().is_same());
}

#[test]
fn replay_can_begin_and_end_in_the_middle() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    fs::write(&path, changed(200, |_| true)).unwrap();
    let part = |from: Option<u64>, until: Option<u64>| {
        let options = Options { from: from.map(Tick), until: until.map(Tick), ..Options::default() };
        replay_with(&path, &options)
    };
    // States are those after ticks 1, 26, 51 ...; the first computed tick is the next one.
    for (from, until, ticks) in [
        (None, Some(40), 40),
        (Some(1), None, 200),
        (Some(2), None, 199),
        (Some(100), None, 124),
        (Some(77), Some(80), 4),
        (Some(60), Some(60), 9),
    ] {
        let report = part(from, until).unwrap();
        assert!(report.is_same(), "{:?}", report.first_difference);
        assert_eq!((report.ticks, report.skipped), (ticks, 0), "{from:?} to {until:?}");
    }
    assert!(matches!(part(Some(500), None), Err(ReplayError::Empty)));
    let bytes = changed(200, |record| {
        record.memory.prim.status.distance += i32::from(record.tick.0 == 42);
        true
    });
    fs::write(&path, bytes).unwrap();
    assert!(!part(None, Some(42)).unwrap().is_same());
    assert!(part(None, Some(41)).unwrap().is_same() && part(Some(60), None).unwrap().is_same());
}

#[test]
fn golden_replays_like_the_run() {
    let scratch = Scratch::new();
    let (path, file) = (scratch.file("run.mcap"), scratch.file("run.golden"));
    fs::write(&path, changed(230, |_| true)).unwrap();
    let log = Log::open(&path).unwrap();
    golden::write(&golden::from_log(&log).unwrap(), &file).unwrap();
    assert!(fs::metadata(&file).unwrap().len() < 8000);
    let read = golden::read(&file).unwrap();
    run(230, |tick, external, _, _| {
        let (at, inputs) = read.inputs().nth(usize::try_from(tick.0).unwrap() - 1).unwrap().unwrap();
        assert_eq!((at, &inputs), (tick, external));
    });
    let played = golden::replay(&read).unwrap();
    assert_eq!((played.ticks, played.difference), (230, None));
    assert_eq!(played.digest.value(), read.digest());
    assert!(
        played.summary.contains(
            "seed     7
"
        ),
        "{}",
        played.summary
    );

    // A change in tick 110 is detected in its second.
    let bytes = changed(230, |record| {
        record.memory.prim.status.distance += i32::from(record.tick.0 == 110);
        true
    });
    fs::write(&path, bytes).unwrap();
    let error = golden::from_log(&Log::open(&path).unwrap()).err().unwrap();
    assert!(error.to_string().contains("its digest is not that of its ticks"), "{error}");
}

#[test]
fn golden_of_a_partial_run_or_other_format_is_refused() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    fs::write(&path, changed(100, |record| record.tick.0 != 50)).unwrap();
    let error = golden::from_log(&Log::open(&path).unwrap()).err().unwrap();
    assert_eq!(error.to_string(), "the log cannot become a golden: ticks are missing");
    let whole = changed(100, |_| true);
    fs::write(&path, &whole[..whole.len() * 2 / 3]).unwrap();
    let error = golden::from_log(&Log::open(&path).unwrap()).err().unwrap();
    assert_eq!(error.to_string(), "the log cannot become a golden: it has no end");
    for bytes in [&b"RCSGOLD\x02whatever"[..], b"", b"RCSGOLD\x01and no compressed bytes"] {
        fs::write(&path, bytes).unwrap();
        assert!(golden::read(&path).is_err_and(|error| error.to_string().contains("not a golden run")));
    }
}

#[test]
fn uncreatable_file_is_reported_before_the_run() {
    let scratch = Scratch::new();
    let in_the_way = scratch.file("file");
    fs::write(&in_the_way, "").unwrap();
    let error = Recorder::start(&in_the_way.join("run.mcap"), Pace::Drop, setup()).err().unwrap();
    assert!(matches!(error, RecordError::Create { .. }), "{error}");
}

#[test]
fn real_time_run_never_waits_and_counts_lost_ticks() {
    let scratch = Scratch::new();
    let path = scratch.file("run.mcap");
    let mut recorder = Recorder::start(&path, Pace::Drop, setup()).unwrap();
    // The run is far faster than any writer, so most ticks find the ring full.
    let digest = run(20_000, |tick, external, memory, state| recorder.tick(tick, external, memory, || state));
    let lost = recorder.lost().ticks;
    let summary =
        recorder.finish(End { digest: Some(digest), result: String::new(), ..End::default() }).unwrap();
    assert!(lost > 0 && summary.ticks + lost == 20_000, "{lost} lost, {} written", summary.ticks);
    let log = Log::open(&path).unwrap();
    assert_eq!(log.end.as_ref().unwrap()["lost_ticks"], lost.to_string());
    let mut next = 1;
    for tick in log.ticks().map(Result::unwrap) {
        assert_eq!(tick.tick.0, next + tick.gap, "every missing tick is in a gap");
        next = tick.tick.0 + 1;
    }
    let report = replay(&path).unwrap();
    assert!(report.is_same(), "{:?}", report.first_difference);
}

#[test]
fn task_data_keep_their_order() {
    let source = |name: &str, text: &str| Source { name: name.into(), text: text.into() };
    let files = Attachment::task_data(&[source("z.blk", "1"), source("a/b.blk", "2")]);
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["taskdata/z.blk", "taskdata/a/b.blk"]);
}

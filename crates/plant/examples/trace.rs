#[path = "../tests/rig/mod.rs"]
mod rig;
use rig::*;
fn show(rig: &mut Rig, what: &str) {
    let tool = rig.cell.tool();
    let rel = tool.inverse().compose(&rig.part_frame());
    let (o, f) = rig.cell.fingers();
    println!("{what:10} opening {o:.4} force {f:.1} rel {:.4} {:.4} {:.4} rot {:?} {:?}", rel.position.x, rel.position.y, rel.position.z, rcs_core::frame::rotation_vector(&rel.rotation).as_slice(), rig.log);
}
fn main() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 1.2, -1.7, 40.0);
    rig.ticks(25);
    println!("{:?}", rig.part());
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(3.0);
    rig.go(rig.grip_frame(4, 1.2, -1.7, 40.0, 8.0), 10.0);
    rig.go_and_stop(rig.grip_frame(4, 1.2, -1.7, 40.0, 0.0), 4.0);
    show(&mut rig, "before");
    println!("tool {:?} want {:?}", rig.cell.tool(), rig.grip_frame(4, 1.2, -1.7, 40.0, 0.0));
    rig.close(30.0);
    show(&mut rig, "closed");
    rig.go(rig.grip_frame(4, 1.2, -1.7, 40.0, 8.0), 4.0);
    show(&mut rig, "up");
    rig.ticks(25);
    show(&mut rig, "rest");
    for via in [UNIT_V1, HOM_SAF_3, HOM_SAF_1, FIX_V1] {
        rig.go(via.to_frame().unwrap(), 10.0);
        show(&mut rig, "via");
    }
}

use interfaces::{CommonMemory, jaws::JawsCommand};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    pub end_effector_id: u8, // `endeff-id#`
    pub closed: f64,         // in
    pub opened: f64,         // in
}

pub trait JawsKind {
    const NAME: &'static str;
    const PARAMETERS: Parameters;

    fn command(memory: &CommonMemory) -> &JawsCommand;
}

/// The gripper for cylindrical parts, end effector 2 (III.3.7).
#[derive(Clone, Copy, Debug, Default)]
pub struct CylindricalPartGripper;

impl JawsKind for CylindricalPartGripper {
    const NAME: &'static str = "V-Grip";
    /// The travel is ASSUMED.
    const PARAMETERS: Parameters = Parameters { end_effector_id: 2, closed: 0.50, opened: 3.50 };

    fn command(memory: &CommonMemory) -> &JawsCommand {
        &memory.emove.v_grip
    }
}

/// The gripper for tools, end effector 3 (III.3.8).
#[derive(Clone, Copy, Debug, Default)]
pub struct ToolGripper;

impl JawsKind for ToolGripper {
    const NAME: &'static str = "Tool-Grip";
    /// The travel is ASSUMED.
    const PARAMETERS: Parameters = Parameters { end_effector_id: 3, closed: 1.00, opened: 4.00 };

    fn command(memory: &CommonMemory) -> &JawsCommand {
        &memory.emove.tool_grip
    }
}

// The control processes and their neighbours: names, places in the hierarchy, and what they move.

/**
 * @typedef {object} Process
 * @property {string} id name of its topics
 * @property {string} name the manual's name
 * @property {string} [short] name where there is little room
 * @property {number} level 0 for Task; its commander is one level above
 * @property {boolean} tabled it has decision tables
 * @property {string[]} meshes bodies of the cell that it moves
 */

const ARM = ['turret', 'upper_arm', 'forearm', 'wrist_pitch', 'wrist_yaw', 'end_plate'];
const PEDESTAL = ['pedestal_hand', 'pedestal_left_finger', 'pedestal_right_finger'];

/** @type {Process[]} All processes, in the order of the keys j and k. */
export const PROCESSES = [
  { id: 'workstation', name: 'Workstation', level: -1, tabled: false, meshes: [] },
  { id: 'task', name: 'Task', level: 0, tabled: true, meshes: [] },
  { id: 'data', name: 'Data System', level: 1, tabled: false, meshes: [] },
  { id: 'subtask', name: 'Subtask', level: 1, tabled: true, meshes: [] },
  { id: 'pedestal', name: 'Active Pedestal', level: 2, tabled: true, meshes: PEDESTAL },
  { id: 'hand', name: 'Pedestal Hand', short: 'Hand', level: 3, tabled: true, meshes: PEDESTAL },
  { id: 'table', name: 'Rotary Table', level: 3, tabled: true, meshes: ['pedestal_hand'] },
  { id: 'emove', name: 'E-move', level: 2, tabled: true, meshes: [] },
  { id: 'vision', name: 'Vision', level: 3, tabled: false, meshes: ['quick_change'] },
  { id: 'quick_change', name: 'Quick Change', level: 3, tabled: true, meshes: ['quick_change'] },
  {
    id: 'grip',
    name: 'Grip',
    level: 3,
    tabled: true,
    meshes: ['parts_gripper', 'left_finger', 'right_finger'],
  },
  {
    id: 'v_grip',
    name: 'V-Grip',
    level: 3,
    tabled: true,
    meshes: ['v_gripper', 'v_left_finger', 'v_right_finger'],
  },
  {
    id: 'tool_grip',
    name: 'Tool-Grip',
    level: 3,
    tabled: true,
    meshes: ['tool_gripper', 'tool_left_finger', 'tool_right_finger'],
  },
  { id: 'prim', name: 'Prim', level: 3, tabled: true, meshes: ARM },
  { id: 't3i', name: 'T3 Interface', level: 4, tabled: true, meshes: [] },
  { id: 'robot', name: 'Robot', level: 5, tabled: false, meshes: ARM },
];

/** Processes with decision tables. */
export const TABLED = PROCESSES.filter((process) => process.tabled).map((process) => process.id);

/** A process by its id. @param {string} id */
export function processOf(id) {
  return PROCESSES.find((process) => process.id === id) ?? PROCESSES[0];
}

/** The id of a process by its name in messages; null if there is none. @param {string} name */
export function idOf(name) {
  if (name === 'HWSC') return 'workstation';
  return PROCESSES.find((process) => process.name === name)?.id ?? null;
}

// The documents and operations of a class (docs/page-interface.md).

// A seat of the class: a robot with its program.
export interface ClassSeat {
  seat: number; // 0: of the teacher
  name: string;
  state: 'starting' | 'ready' | 'ended';
  problem: string | null;
  connections: number; // of the person's pages; 0: not there
  path: string;
  token: string;
  recordings: number;
}

export interface ClassDocument {
  limit: number; // robots of learners that run at a time
  is_locked: boolean;
  code: string;
  address: string; // of the entry
  folder: string;
  teacher: ClassSeat | null;
  learners: ClassSeat[]; // by seat
}

// What can be handed out.
export interface ClassProject {
  file: string;
  group: string;
  title: string;
  text: string;
}

// The value of `class.hand_out`.
export interface HandOutResult {
  handed: { seat: number; file: string }[];
  failed: { seat: number; error: string }[];
}

// The value of `class.collect`: numbers of recordings.
export interface CollectResult {
  copied: number;
  known: number;
  running: number;
  failed: { seat: number; error: string }[];
}

// Without `seats`: all learners.
interface Seats {
  seats?: readonly number[];
}

export interface ClassOperations {
  'class.projects': Record<string, never>;
  'class.hand_out': Seats & { file: string };
  'class.collect': Seats;
  'class.message': Seats & { text: string };
  'class.lock': { locked: boolean };
  'class.let_in': { seat: number };
  'class.restart': { seat: number };
  'class.remove': { seat: number };
}

// The stores of the teacher's page: the class, its robots, the connection, STOP.
import { computed, effect, signal } from '@preact/signals-core';
import { OperationQueue } from '../state/operations.js';
import { PageState } from '../state/page_state.js';
import { StopControl } from '../state/stop_report.js';
import { openDialog } from '../view/dialogs.js';
import type { PageName } from '../view/robot_view.js';
import { storeChoice, storedChoice } from '../view/stored_choice.js';
import type { FromConnectionWorker, ToConnectionWorker } from '../wire/connection_worker.js';
import type { ClassDocument, ClassSeat } from '../wire/messages.js';
import { openStopChannel } from '../wire/open_stop_channel.js';
import { socketAddress, type PageAddress } from '../wire/page_address.js';
import type { TileNews, ToTileWorker, WatchedSeat } from './tile_messages.js';
import { inOrder, orders, type Order } from './tile_order.js';
import { Tile } from './tiles.js';

const orderKey = 'proleg.class.order';
const speedPeriod = 2000; // milliseconds; tiles that change places more often cannot be pressed

// The dialog that is open; `seat`: the learner whom it is about, else all of them can be chosen.
export type ClassDialog = { kind: 'hand_out' | 'message'; seat: ClassSeat | null } | { kind: 'collect' } | { kind: 'seat'; seat: ClassSeat };

export class ClassApp {
  readonly state = new PageState();
  readonly shownPage = signal<PageName>('live'); // so that no notice waits
  readonly room = signal<ClassDocument | null>(null);
  readonly order = signal<Order>(Object.keys(orders).find((order): order is Order => order === storedChoice(orderKey)) ?? 'name');
  readonly dialog = signal<ClassDialog | null>(null);
  readonly isWayInLarge = signal(false);
  readonly operations: OperationQueue;
  readonly stop: StopControl;
  // The teacher's own robot comes first.
  readonly seats = computed(() => {
    const room = this.room.value;
    if (room === null) return [];
    return [...(room.teacher === null ? [] : [room.teacher]), ...inOrder(room.learners, this.order.value, this.speeds.value)];
  });
  private readonly speeds = signal<ReadonlyMap<number, number | null>>(new Map());
  private readonly tiles = new Map<number, Tile>();
  private readonly connection = new Worker('connection_worker.js');
  private readonly watcher = new Worker('tile_worker.js');

  constructor(address: PageAddress, token: string) {
    this.operations = new OperationQueue(this.state, (request) => this.post({ kind: 'operation', request }));
    this.stop = new StopControl(openStopChannel(address, token, 'Teacher'));
    this.connection.onmessage = (event: MessageEvent<FromConnectionWorker>) => this.receive(event.data);
    this.watcher.onmessage = ({ data }: MessageEvent<TileNews[]>) => {
      for (const news of data) this.tileOf(news.seat).receive(news);
    };
    this.post({ kind: 'open', url: address.socket, token, name: 'Teacher', wantsControl: false });
    this.watchSeats();
    const show = () => this.tellWatcher({ kind: 'show', isShown: !document.hidden });
    document.addEventListener('visibilitychange', show);
    show();
    // A robot that moves again is not stopped.
    const moves = computed(() => this.seats.value.some(({ seat }) => this.tileOf(seat).session.value?.state === 'running'));
    effect(() => {
      if (moves.value) this.stop.clear();
    });
    setInterval(() => this.noteSpeeds(), speedPeriod);
  }

  tileOf(seat: number): Tile {
    const tile = this.tiles.get(seat) ?? new Tile();
    this.tiles.set(seat, tile);
    return tile;
  }

  show(dialog: ClassDialog): void {
    this.dialog.value = dialog;
    openDialog.value = 'class';
  }

  sort(order: Order): void {
    storeChoice(orderKey, order);
    this.noteSpeeds();
    this.order.value = order;
  }

  // Robots that run; the others have no connection to keep.
  private watchSeats(): void {
    const wanted = computed(() => {
      const room = this.room.value;
      const seats = room === null ? [] : [...(room.teacher === null ? [] : [room.teacher]), ...room.learners];
      const ready = seats.filter(({ state }) => state === 'ready');
      return JSON.stringify(ready.map(({ seat, path, token }): WatchedSeat => ({ seat, token, url: socketAddress(location, path, true) })));
    });
    effect(() => {
      const seats = JSON.parse(wanted.value) as WatchedSeat[];
      for (const [number, tile] of this.tiles) {
        if (!seats.some(({ seat }) => seat === number)) tile.forget();
      }
      this.tellWatcher({ kind: 'watch', seats });
    });
  }

  private noteSpeeds(): void {
    this.speeds.value = new Map([...this.tiles].map(([seat, { session }]) => [seat, session.peek()?.speed ?? null]));
  }

  private tellWatcher(message: ToTileWorker): void {
    this.watcher.postMessage(message);
  }

  private post(message: ToConnectionWorker): void {
    this.connection.postMessage(message);
  }

  private receive(message: FromConnectionWorker): void {
    switch (message.kind) {
      case 'alive?':
        return this.post({ kind: 'alive' });
      case 'status':
        return this.state.receiveStatus(message.status);
      case 'message':
        if (message.message.type === 'document' && message.message.name === 'class') this.room.value = message.message.value;
        return this.state.receive(message.message);
      case 'result':
        return this.operations.receive(message.key, message.result);
      case 'latency':
      case 'telemetry':
        return;
    }
  }
}

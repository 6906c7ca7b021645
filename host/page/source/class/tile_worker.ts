// The worker that has the connections to the robots of a class. Their documents can be large: reading them on the main thread
// would hold up STOP.
import { openSocket } from '../wire/web_socket.js';
import { SeatWatch } from './seat_watch.js';
import type { TileNews, ToTileWorker, WatchedSeat } from './tile_messages.js';

const picturePeriod = 150; // milliseconds

const watches = new Map<number, SeatWatch>();
let isShown = true;

const isSame = (one: WatchedSeat, other: WatchedSeat) => one.token === other.token && one.url === other.url;

function watch(seats: readonly WatchedSeat[]): void {
  for (const [number, known] of watches) {
    if (seats.some((seat) => seat.seat === number && isSame(seat, known.seat))) continue;
    known.close();
    watches.delete(number);
  }
  for (const seat of seats) {
    if (watches.has(seat.seat)) continue;
    const ports = {
      openSocket: openSocket.bind(null, seat.url),
      now: () => performance.now(),
      after: (ms: number, action: () => void) => void setTimeout(action, ms),
    };
    watches.set(seat.seat, new SeatWatch(seat, ports));
  }
}

self.onmessage = ({ data }: MessageEvent<ToTileWorker>) => {
  if (data.kind === 'watch') {
    watch(data.seats);
  } else {
    isShown = data.isShown;
    if (!isShown) for (const known of watches.values()) known.rest();
  }
};

setInterval(() => {
  if (!isShown) return;
  const news = [...watches.values()].map((known) => known.takeNews()).filter((one): one is TileNews => one !== null);
  if (news.length > 0) self.postMessage(news);
  for (const known of watches.values()) known.look();
}, picturePeriod);

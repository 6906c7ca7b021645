// Opens the channel for STOP of the program at an address.
import { fittingName } from './messages.js';
import type { PageAddress } from './page_address.js';
import { StopChannel } from './stop_channel.js';
import { openSocket } from './web_socket.js';

export function openStopChannel({ socket: url, stop }: Pick<PageAddress, 'socket' | 'stop'>, token: string, name: string): StopChannel {
  const channel = new StopChannel(token, fittingName(`STOP of ${name}`), {
    openSocket: (events) => openSocket(url, events),
    post: async () => {
      const response = await fetch(stop, { method: 'POST', headers: { Authorization: `Bearer ${token}` }, keepalive: true });
      if (!response.ok) {
        throw new Error(`the program answered ${response.status}`);
      }
    },
    now: () => performance.now(),
    after: (ms, action) => void setTimeout(action, ms),
  });
  channel.open();
  return channel;
}

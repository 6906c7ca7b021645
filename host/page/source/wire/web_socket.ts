// A WebSocket of the browser, as a connection uses it.
import type { Socket, SocketEvents } from './connection.js';

export function openSocket(url: string, events: SocketEvents): Socket {
  const socket = new WebSocket(url);
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => events.opened();
  socket.onclose = (event) => events.closed(event.code, event.reason);
  socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
    if (typeof event.data === 'string') {
      events.text(event.data);
    } else {
      events.binary(event.data);
    }
  };
  return socket;
}

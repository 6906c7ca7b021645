// One line about a connection that is not open.
import type { ConnectionStatus } from '../wire/connection.js';

interface Properties {
  status: ConnectionStatus;
  isSeat: boolean; // the robot of somebody in a class
}

// `isSeat`: who sits there can neither start the program nor read what it prints.
export function describeConnection(status: ConnectionStatus, isSeat: boolean): string | null {
  switch (status.state) {
    case 'open':
      return null;
    case 'connecting':
      return 'Connecting to the program …';
    case 'lost':
      return `No connection to the program; the robot may go on. What you see is old. Connecting again (attempt ${status.attempts}) …`;
    case 'ended':
      return isSeat
        ? 'The program of this robot has ended. What you see is old. If your teacher starts it again, this page goes on by itself.'
        : 'The program has ended. What you see is old. Start it again with “proleg ui”, and open the address that it prints.';
    case 'refused':
      return isSeat
        ? 'This page has lost its robot: your teacher has removed it or let you in again.'
        : `The program does not accept this page (${status.reason || 'without a reason'}). Open the address that “proleg ui” prints.`;
  }
}

export function ConnectionBand({ status, isSeat }: Properties) {
  const text = describeConnection(status, isSeat);
  if (text === null) return null;
  return (
    <div class={`band ${status.state === 'connecting' ? 'info' : 'lost'}`} role="alert" data-testid="connection-band">
      {text}
      {isSeat && status.state === 'refused' && <a href="/">Go to the start page of the class</a>}
    </div>
  );
}

// The teacher's page: STOP for all, the way in, and a tile for each robot.
import { ConnectionBand } from '../panels/connection_band.js';
import { NoticeList } from '../panels/notice_list.js';
import { ThemeButton } from '../panels/page_tools.js';
import { StopArea } from '../panels/stop_area.js';
import { openDialog } from '../view/dialogs.js';
import type { ClassDocument } from '../wire/messages.js';
import type { ClassApp } from './class_app.js';
import { CollectDialog } from './collect_dialog.js';
import { HandOutDialog } from './hand_out_dialog.js';
import { MessageDialog } from './message_dialog.js';
import { SeatDialog } from './seat_dialog.js';
import { orders, type Order } from './tile_order.js';
import { countText } from './tile_text.js';
import { TileView } from './tile_view.js';
import { LargeWayIn, WayIn } from './way_in.js';

function ClassActions({ app }: { app: ClassApp }) {
  return (
    <section class="class-actions" aria-label="The class">
      <button type="button" class="primary" onClick={() => app.show({ kind: 'hand_out', seat: null })}>
        Hand out …
      </button>
      <button type="button" onClick={() => app.show({ kind: 'collect' })}>
        Collect recordings
      </button>
      <button type="button" onClick={() => app.show({ kind: 'message', seat: null })}>
        Message …
      </button>
      <label>
        Sort by{' '}
        <select value={app.order.value} onChange={(event) => app.sort(event.currentTarget.value as Order)}>
          {Object.entries(orders).map(([order, title]) => (
            <option key={order} value={order}>
              {title}
            </option>
          ))}
        </select>
      </label>
    </section>
  );
}

function DialogOfClass({ app }: { app: ClassApp }) {
  const dialog = app.dialog.value;
  if (openDialog.value !== 'class' || dialog === null) return null;
  switch (dialog.kind) {
    case 'hand_out':
      return <HandOutDialog app={app} seat={dialog.seat} />;
    case 'message':
      return <MessageDialog app={app} seat={dialog.seat} />;
    case 'collect':
      return <CollectDialog app={app} />;
    case 'seat':
      return <SeatDialog app={app} seat={dialog.seat} />;
  }
}

function Content({ app, room }: { app: ClassApp; room: ClassDocument }) {
  return (
    <>
      <div class="class-head">
        <WayIn app={app} room={room} />
        <ClassActions app={app} />
      </div>
      <ul class="tiles" aria-label="Robots">
        {app.seats.value.map((seat) => (
          <TileView key={seat.seat} app={app} seat={seat} />
        ))}
      </ul>
      {room.learners.length === 0 && <p class="wait">Nobody has joined yet. Show the address and the code: “Show large”.</p>}
    </>
  );
}

export function ClassPage({ app }: { app: ClassApp }) {
  const room = app.room.value;
  const connection = app.state.connection.value;
  return (
    <>
      <header class="top-bar class-bar">
        <div class="robot-name">
          <h1>Class</h1>
          {room !== null && (
            <span class="count" data-testid="count">
              {countText(room)}
            </span>
          )}
        </div>
        <div class="tools">
          <ThemeButton />
        </div>
        <StopArea stop={app.stop} isSimulation ofClass />
      </header>
      <div class="bands">
        <ConnectionBand status={connection} isSeat={false} />
        {connection.state === 'refused' && (
          <div class="band info">
            <a href="/">To the entry of learners</a>
          </div>
        )}
      </div>
      <main class="class-page">{room === null ? <p class="wait">Waiting for the class …</p> : <Content app={app} room={room} />}</main>
      {app.isWayInLarge.value && room !== null && <LargeWayIn app={app} room={room} />}
      <NoticeList app={app} />
      <DialogOfClass app={app} />
    </>
  );
}

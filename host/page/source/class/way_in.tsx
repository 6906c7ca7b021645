// How learners come in: address and code, also large for a projector.
import { useEffect } from 'preact/hooks';
import { LaterView, loadLater } from '../panels/later_view.js';
import { addFront } from '../view/front.js';
import type { ClassDocument } from '../wire/messages.js';
import type { ClassApp } from './class_app.js';
import { codeText, isOnlyHere, linkForLearners } from './tile_text.js';

const qrCode = loadLater<string>(() => import('./qr_code.js').then((module) => module.QrCode));

export function WayIn({ app, room }: { app: ClassApp; room: ClassDocument }) {
  const lock = () => void app.operations.tell('class.lock', { locked: !room.is_locked });
  return (
    <section class="panel way-in" aria-label="How learners join">
      <dl>
        <div>
          <dt>Address</dt>
          <dd data-testid="address">{room.address}</dd>
        </div>
        <div>
          <dt>Code</dt>
          <dd data-testid="code">{codeText(room.code)}</dd>
        </div>
      </dl>
      <div class="fields">
        <button type="button" onClick={() => (app.isWayInLarge.value = true)}>
          Show large
        </button>
        <button type="button" aria-pressed={room.is_locked} title="Nobody new can join. Who has joined comes in again." onClick={lock}>
          {room.is_locked ? 'Locked' : 'Lock'}
        </button>
        {room.is_locked && <span class="hint">Nobody new can join.</span>}
      </div>
      {isOnlyHere(room.address) && (
        <p class="hint">Only browsers on this computer reach this address. For other computers, start proleg ui with --lan.</p>
      )}
    </section>
  );
}

export function LargeWayIn({ app, room }: { app: ClassApp; room: ClassDocument }) {
  const close = () => (app.isWayInLarge.value = false);
  useEffect(() => addFront({ isOpen: () => true, close }), []);
  return (
    <section class="large-way-in" role="dialog" aria-label="How to join">
      <div class="large-texts">
        <p>Open</p>
        <p class="large-address">{room.address}</p>
        <p>Code</p>
        <p class="large-code">{codeText(room.code)}</p>
        {room.is_locked && <p class="problem">The class is locked: nobody new can join.</p>}
        <button type="button" class="primary" autofocus onClick={close}>
          Close
        </button>
      </div>
      <LaterView app={linkForLearners(room)} part={qrCode()} wait="" />
    </section>
  );
}

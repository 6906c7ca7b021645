// A signal for what a test gives to the page. It is made by the page's own copy of the library: signals of another copy are not
// noticed by its effects.
import { PageState } from '../../../../host/page/source/state/page_state.js';

export interface PageSignal<Value> {
  value: Value;
  peek(): Value;
  subscribe(noted: (value: Value) => void): () => void;
}

export function pageSignal<Value>(value: Value): PageSignal<Value> {
  const made = new PageState().draft as unknown as PageSignal<Value>;
  made.value = value;
  return made;
}

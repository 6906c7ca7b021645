// Everything that a key, the palette or a button can start, in one list.

export interface Action {
  id: string;
  title: string;
  group: 'Robot' | 'Recording' | 'View' | 'Parameters' | 'Make' | 'Page';
  keys: readonly string[]; // values of KeyboardEvent.key, with 'Ctrl+' and 'Shift+' in front; the first key is shown
  isEnabled?: () => boolean;
  // The reason why the action is not enabled, unless the viewer lacks control.
  obstacle?: () => string | null;
  // False if the action does not fit this kind of robot: it is not listed and its key does nothing.
  isShown?: () => boolean;
  // Whether the key works in text fields, too: only for actions that must always work.
  isGlobal?: boolean;
  // Whether the key comes before elements that use it themselves, such as sliders; not in text fields.
  isBeforeElements?: boolean;
  // The key is only listed: the browser makes an event of it, which the page handles.
  isLeftToBrowser?: boolean;
  run(): void;
}

export interface KeyPress {
  key: string;
  ctrlKey: boolean;
  metaKey: boolean;
  shiftKey: boolean;
  altKey: boolean;
}

// The name of a key, in which the case of letters does not matter: with Caps Lock, `k` is `K`.
function nameOf(press: KeyPress): string {
  const key = press.key === ' ' ? 'Space' : press.key.length === 1 ? press.key.toUpperCase() : press.key;
  const isSymbol = press.key.length === 1 && press.key.toUpperCase() === press.key.toLowerCase();
  // `?` and the like need Shift on some keyboards only.
  const shift = press.shiftKey && !isSymbol ? 'Shift+' : '';
  return `${press.ctrlKey || press.metaKey ? 'Ctrl+' : ''}${shift}${key}`;
}

export class ActionList {
  private readonly list: Action[] = [];

  // `parent`: actions that this list has, too, if they fulfil the condition. Of one key, the action of this list counts.
  constructor(
    private readonly parent: ActionList | null = null,
    private readonly isShared: (action: Action) => boolean = () => true,
  ) {}

  get all(): readonly Action[] {
    const own = this.list.filter((action) => action.isShown?.() !== false);
    return [...own, ...(this.parent?.all.filter(this.isShared) ?? [])];
  }

  add(...actions: Action[]): void {
    for (const action of actions) {
      for (const key of action.keys) {
        // Those that are not always shown may have a key in turn.
        const other = this.list.find((known) => known.keys.includes(key) && (known.isShown === undefined || action.isShown === undefined));
        if (other !== undefined) {
          throw new Error(`key ${key}: found in ${other.id} and ${action.id}, expected one action`);
        }
      }
      this.list.push(action);
    }
  }

  find(id: string): Action | undefined {
    return this.list.find((action) => action.id === id);
  }

  // The enabled action of a key; `isText`: the focus is in a text field.
  forKey(press: KeyPress, isText: boolean): Action | undefined {
    if (press.altKey) {
      return undefined;
    }
    const name = nameOf(press);
    return this.all.find(
      (action) =>
        action.isLeftToBrowser !== true && action.keys.includes(name) && (!isText || action.isGlobal === true) && action.isEnabled?.() !== false,
    );
  }

  // The actions whose title has all words of the text.
  matching(text: string): Action[] {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    return this.all.filter((action) => words.every((word) => `${action.group} ${action.title}`.toLowerCase().includes(word)));
  }
}

// The keys of the people who have joined the class at this computer. Who has the key of a name gets its robot again.

export interface NameKey {
  name: string;
  key: string;
}

type KeyStorage = Pick<Storage, 'getItem' | 'setItem'>;

const storageKey = 'proleg.class';

// As the program compares names: the case of ASCII letters does not count.
function isSameName(one: string, other: string): boolean {
  const plain = (name: string) => name.replace(/[A-Z]/g, (letter) => letter.toLowerCase());
  return plain(one) === plain(other);
}

function isNameKey(value: unknown): value is NameKey {
  const { name, key } = (value ?? {}) as Partial<NameKey>;
  return typeof name === 'string' && typeof key === 'string';
}

// 256 random bits in base64url, as the program makes them.
export function makeKey(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(32));
  return btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}

export class KeyStore {
  constructor(private readonly storage: KeyStorage) {}

  // The last one that joined comes first. What another program has stored there is ignored.
  all(): NameKey[] {
    try {
      const stored: unknown = JSON.parse(this.storage.getItem(storageKey) ?? '[]');
      return Array.isArray(stored) ? stored.filter(isNameKey) : [];
    } catch {
      return [];
    }
  }

  keyOf(name: string): string | null {
    return this.all().find((known) => isSameName(known.name, name))?.key ?? null;
  }

  keep(name: string, key: string): void {
    this.store([{ name, key }, ...this.others(name)]);
  }

  forget(name: string): void {
    this.store(this.others(name));
  }

  private others(name: string): NameKey[] {
    return this.all().filter((known) => !isSameName(known.name, name));
  }

  private store(keys: readonly NameKey[]): void {
    this.storage.setItem(storageKey, JSON.stringify(keys));
  }
}

// The search. Its index comes as a script, because a browser fetches no file in a page that was opened as a file. Nor does it load
// a worker there: then the program of the worker runs in a frame, which has the worker's functions.
const base = document.currentScript.dataset.base;
// The theme asks __search for an index before it fetches one.
window.__search = {
  index: new Promise((resolve) => {
    window.set_search_index = resolve;
    const script = document.createElement("script");
    script.src = `${base}/search/search_index.js`;
    document.head.append(script);
  }),
};

if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    constructor(address) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      this.waiting = [];
      const inside = this.frame.contentWindow;
      inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      const program = inside.document.createElement("script");
      program.src = new URL(address, location.href).href;
      program.onload = () => {
        for (const data of this.waiting) this.deliver(data);
        this.waiting = null;
      };
      inside.document.body.append(program);
    }
    postMessage(data) {
      if (this.waiting) this.waiting.push(data);
      else this.deliver(data);
    }
    deliver(data) {
      this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data }));
    }
  };
  window.Worker = window.IFrameWorker;
}

// Puts the load page together.
import "./style.css";
import "./load/style.css";

import { LoadPage } from "./load/page.js";
import { head } from "./ui/shell.js";
import { words } from "./words.js";

const page = new LoadPage();
document.getElementById("root")!.append(head("load", "load", words.load.skip), page.element);
page.show(true);
// What tests look at.
Object.assign(window, { load: page });

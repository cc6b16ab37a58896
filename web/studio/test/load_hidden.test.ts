// The load page where the gateway shows nobody how busy it is.
import { after, before, test } from "node:test";

import { Stack } from "./support/stack.js";

const stack = new Stack();
before(() => stack.start());
after(() => stack.stop());

test("it says what an operator has to do", async () => {
  const page = await stack.visit({}, "load.html");
  await page.getByText("The gateway does not show its load here.").waitFor();
  await page.getByText("--arapd-admin http://127.0.0.1:PORT").waitFor();
  await page.locator(".charts").waitFor({ state: "hidden" });
  await page.getByRole("link", { name: "Puppet" }).click();
  await page.getByRole("heading", { name: "Puppet studio" }).waitFor();
  await page.context().close();
});

//! What random graphs grow by.

use std::fmt::Write as _;

use super::{Builder, What};

impl Builder<'_> {
    /// Grows the graph by something.
    pub(super) fn step(&mut self) {
        match self.below(24) {
            0 => {
                let (src, dst) = self.pair(|what| matches!(what, What::Buffer { .. }));
                self.copy_items(&src, &dst);
            }
            1 => {
                let dst = self.written(|what| matches!(what, What::Buffer { .. }));
                let dst = self.name(dst);
                let fields = format!("shader: \"add.wgsl\", each: Item(\"{dst}\"), bind: {{\"dst\": \"{dst}\"}}");
                self.pass("Compute", &fields);
            }
            2 => {
                let (from, to) = self.pair(|_| true);
                self.pass("Copy", &format!("from: \"{from}\", to: \"{to}\""));
            }
            3 => {
                let (mip, layer) = (self.below(3), self.below(2));
                let (from, to) = self.pair(|what| matches!(what, What::Texture { layers: 2, .. }));
                let part = |name: &str| format!("View(of: \"{name}\", mip: {mip}, layer: {layer})");
                self.pass("Copy", &format!("from: {}, to: {}", part(&from), part(&to)));
            }
            4 => {
                let (mip, layer) = (self.below(3), self.below(2));
                let i = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
                let fields =
                    format!("of: \"{}\", mip: {mip}, layer: {layer}, value: (0.1, 0.2, 0.3, 1.0)", self.name(i));
                self.pass("Clear", &fields);
            }
            5 => self.filter(),
            6 => self.looped(),
            7 => self.branch(),
            8 => self.appended(),
            9 => self.sampled(),
            10 => self.triangles(),
            11 => self.resolved(),
            12 => {
                let i = self.below(self.things.len() as u32) as usize;
                self.write(i);
            }
            13 => self.layered(),
            14 => self.valued(),
            15 => self.indexed(),
            16 => self.two_targets(),
            17 => self.stencilled(),
            18 => self.sliced(),
            19 => self.masked(),
            20 => {
                let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
                let dst = self.name(dst);
                self.pass("Fullscreen", &format!("shader: \"seen.wgsl\", color: [(to: \"{dst}\", write: \"rgb\")]"));
            }
            21 => {
                let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
                let dst = self.name(dst);
                self.pass(
                    "Fullscreen",
                    &format!("shader: \"filter.wgsl\", color: [\"{dst}\"], bind: {{\"src\": \"picture\"}}"),
                );
            }
            22 => {
                let dst = self.written(|what| matches!(what, What::Buffer { .. }));
                let dst = self.name(dst);
                self.copy_items("given", &dst);
            }
            _ => self.bundled(),
        }
    }

    /// Parameters, the picture's size, time and a loop's counter in a uniform; a constant.
    fn valued(&mut self) {
        let dst = self.written(|what| matches!(what, What::Buffer { .. }));
        let dst = self.name(dst);
        let before = self.passes;
        _ = writeln!(self.text, "      Repeat(times: 2, index: \"turn\", passes: [");
        let fields = format!(
            "shader: \"values.wgsl\", each: Item(\"{dst}\"), bind: {{\"dst\": \"{dst}\", \"turn\": \"turn\", \"factor\": \"2.5 * turn\"}}"
        );
        self.pass("Compute", &fields);
        self.text.push_str("      ]),\n");
        self.passes = before + 2;
    }

    /// Indices from a buffer; as many as there are, or some of them.
    fn indexed(&mut self) {
        let indices = self.written(|what| matches!(what, What::Buffer { .. }));
        let target = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let (indices, target) = (self.name(indices), self.name(target));
        let count = ["", ", vertices: 1"][self.below(2) as usize];
        let strip = ["TriangleList", "TriangleStrip", "LineStrip"][self.below(3) as usize];
        let fields = format!(
            "shader: \"triangle.wgsl\", indices: \"{indices}\"{count}, topology: {strip}, cull: Back, color: [\"{target}\"]"
        );
        self.pass("Draw", &fields);
    }

    fn two_targets(&mut self) {
        for name in ["parts_a", "parts_b"] {
            let i = self.things.iter().position(|thing| thing.name == name).unwrap();
            if !self.things[i].is_written() {
                self.write(i);
            }
        }
        let (mip, a, b) = (self.below(3), self.below(2), self.below(2));
        let fields = format!(
            "shader: \"two.wgsl\", color: [(to: \"parts_a\", mip: {mip}, layer: {a}), (to: \"parts_b\", mip: {mip}, layer: {b}, blend: Max)]"
        );
        self.pass("Fullscreen", &fields);
    }

    fn stencilled(&mut self) {
        let target = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
        self.written(|what| matches!(what, What::Stencil { .. }));
        let target = self.name(target);
        let depth = [
            "(to: \"stencil\", compare: Always, write: false, stencil: (compare: Always, pass: Replace, reference: 3))",
            "(to: \"stencil\", compare: GreaterEqual, write: true, clear: 0.0, bias: (2, 1.5), stencil: (compare: Equal, reference: 3))",
        ][self.below(2) as usize];
        let fields = format!(
            "shader: \"triangle.wgsl\", vertices: 3, color: [(to: \"{target}\", layer: 0)], depth: Depth{depth}"
        );
        self.pass("Draw", &fields);
    }

    /// A slice of a volume, and whole numbers.
    fn sliced(&mut self) {
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let volume = self.written(|what| *what == What::Volume);
        let numbers = self.written(|what| *what == What::Numbers);
        let (dst, volume, numbers) = (self.name(dst), self.name(volume), self.name(numbers));
        let fields = format!(
            "shader: \"slice.wgsl\", color: [\"{dst}\"], bind: {{\"volume\": \"{volume}\", \"numbers\": \"{numbers}\"}}"
        );
        self.pass("Fullscreen", &fields);
    }

    /// Some channels, or a region.
    fn masked(&mut self) {
        let dst = self.written(|what| matches!(what, What::Texture { size: 1, layers: 1, mips: 1, .. }));
        let dst = self.name(dst);
        let fields = match self.below(2) {
            0 => format!("shader: \"paint.wgsl\", color: [(to: \"{dst}\", write: \"rg\")]"),
            _ => format!("shader: \"paint.wgsl\", color: [\"{dst}\"], region: (1, 2, \"3 + times\", 4)"),
        };
        self.pass("Fullscreen", &fields);
    }

    /// Nothing to do: no threads, no vertices, no instances.
    fn bundled(&mut self) {
        let target = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let list = self.written(|what| *what == What::List);
        let (target, list) = (self.name(target), self.name(list));
        self.pass("Compute", "shader: \"append.wgsl\", each: Threads(0)");
        let draw = format!("shader: \"triangle.wgsl\", vertices: 0, color: [(to: \"{target}\", clear: 0.5)]");
        self.pass("Draw", &draw);
        let groups = format!("shader: \"group.wgsl\", groups: Each(\"{list}\")");
        self.written(|what| matches!(what, What::Buffer { items: 1 }));
        self.pass("Compute", &groups);
    }

    fn copy_items(&mut self, src: &str, dst: &str) {
        let fields =
            format!("shader: \"copy.wgsl\", each: Item(\"{dst}\"), bind: {{\"src\": \"{src}\", \"dst\": \"{dst}\"}}");
        self.pass("Compute", &fields);
    }

    /// One texture is made from another, over what is there or not.
    fn filter(&mut self) {
        let src = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        if src == dst {
            return;
        }
        let is_blendable = matches!(self.things[dst].what, What::Texture { format: 0 | 2, .. });
        let how = match self.below(4) {
            0 => ", clear: 0.0",
            1 if is_blendable => ", blend: Add",
            2 if is_blendable => ", blend: Alpha, clear: (0.0, 0.0, 0.0, 1.0)",
            _ => "",
        };
        let (src, dst) = (self.name(src), self.name(dst));
        let fields = format!("shader: \"filter.wgsl\", color: [(to: \"{dst}\"{how})], bind: {{\"src\": \"{src}\"}}");
        self.pass("Fullscreen", &fields);
    }

    fn looped(&mut self) {
        let (a, b) = self.pair(|what| matches!(what, What::Texture { layers: 1, .. } | What::Buffer { .. }));
        let times = ["0", "2", "3", "\"times\""][self.below(4) as usize];
        let count = match times {
            "\"times\"" => self.times as usize,
            number => number.parse().unwrap(),
        };
        let before = self.passes;
        _ = writeln!(
            self.text,
            "      Repeat(times: {times}, index: \"i{}\", swap: [(\"{a}\", \"{b}\")], passes: [",
            self.names
        );
        if a.starts_with("items") {
            self.copy_items(&a, &b);
        } else {
            self.pass("Fullscreen", &format!("shader: \"filter.wgsl\", color: [\"{b}\"], bind: {{\"src\": \"{a}\"}}"));
        }
        self.text.push_str("      ]),\n");
        self.passes = before + (self.passes - before) * count;
    }

    /// Both branches write what is written already, so that either is right.
    fn branch(&mut self) {
        let dst = self.written(|what| matches!(what, What::Buffer { .. }));
        let dst = self.name(dst);
        let test = ["fancy", "not fancy", "times > 1 and fancy"][self.below(3) as usize];
        let before = self.passes;
        _ = writeln!(self.text, "      If(test: \"{test}\", then: [");
        let fields = format!("shader: \"fill.wgsl\", each: Item(\"{dst}\"), bind: {{\"dst\": \"{dst}\"}}");
        self.pass("Compute", &fields);
        self.text.push_str("      ], else: [\n");
        self.pass("Clear", &format!("of: \"{dst}\", value: 3"));
        self.text.push_str("      ]),\n");
        self.passes = before + 1;
    }

    /// What was appended is used by threads, by points, or not at all.
    fn appended(&mut self) {
        let list = self.written(|what| *what == What::List);
        debug_assert_eq!(self.things[list].name, "list");
        if self.below(3) == 0 {
            self.pass("Clear", "of: \"list\"");
        }
        for _ in 0..self.below(3) {
            let n = self.below(200);
            self.pass("Compute", &format!("shader: \"append.wgsl\", each: Threads({n}, 1, 1)"));
        }
        match self.below(3) {
            0 => {
                let dst = self.written(|what| matches!(what, What::Buffer { items: 100 }));
                let dst = self.name(dst);
                self.pass(
                    "Compute",
                    &format!("shader: \"consume.wgsl\", each: Item(\"list\"), bind: {{\"dst\": \"{dst}\"}}"),
                );
            }
            1 => {
                let target = self.written(|what| matches!(what, What::Texture { format: 0, layers: 1, mips: 1, .. }));
                let target = self.name(target);
                let fields = format!(
                    "shader: \"points.wgsl\", vertices: 1, topology: PointList, instances: Each(\"list\"), color: [(to: \"{target}\")]"
                );
                self.pass("Draw", &fields);
            }
            _ => {}
        }
    }

    /// Mips that the planner makes.
    fn sampled(&mut self) {
        let src = self.written(|what| matches!(what, What::Texture { auto: true, .. }));
        let dst = self.written(|what| matches!(what, What::Texture { format: 0, layers: 1, mips: 1, .. }));
        let (src, dst) = (self.name(src), self.name(dst));
        self.pass("Fullscreen", &format!("shader: \"sample.wgsl\", color: [\"{dst}\"], bind: {{\"src\": \"{src}\"}}"));
        if self.below(2) == 0 {
            let i = self.things.iter().position(|thing| thing.name == src).unwrap();
            self.write(i);
        }
    }

    fn triangles(&mut self) {
        let target = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
        let (target, layer) = (self.name(target), self.below(2));
        let depth = match self.below(4) {
            0 => ", depth: Nearest(\"depth\")",
            1 => ", depth: Farthest(\"depth\")",
            2 => {
                self.written(|what| matches!(what, What::Depth { .. }));
                ", depth: Test(\"depth\")"
            }
            _ => "",
        };
        if depth.contains("est(\"depth\")") && !depth.contains(": Test") {
            let i = self.things.iter().position(|thing| thing.name == "depth").unwrap();
            self.things[i].written.fill(true);
        }
        let geometry = if self.below(2) == 0 {
            self.written(|what| *what == What::Arguments);
            format!("draw: Indirect(buffer: \"arguments\", item: {})", self.below(4))
        } else {
            format!("vertices: {}, instances: {}", 3 * self.below(3), self.below(3))
        };
        let clear = if self.below(2) == 0 { ", clear: 0.0" } else { "" };
        let fields =
            format!("shader: \"triangle.wgsl\", {geometry}, color: [(to: \"{target}\", layer: {layer}{clear})]{depth}");
        self.pass("Draw", &fields);
    }

    fn resolved(&mut self) {
        let samples = self.things.iter().position(|thing| thing.name == "samples_a").unwrap();
        if !self.things[samples].is_written() {
            self.write(samples);
        }
        let fields =
            "shader: \"triangle.wgsl\", vertices: 3, samples: 4, color: [(to: \"samples_a\", resolve: \"resolved\")]";
        self.pass("Draw", fields);
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let dst = self.name(dst);
        self.pass(
            "Fullscreen",
            &format!("shader: \"filter.wgsl\", color: [\"{dst}\"], bind: {{\"src\": \"resolved\"}}"),
        );
    }

    fn layered(&mut self) {
        let src = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let (src, dst) = (self.name(src), self.name(dst));
        let of = if self.below(2) == 0 {
            format!("\"{src}\"")
        } else {
            format!("View(of: \"{src}\", mip: {})", self.below(3))
        };
        self.pass("Fullscreen", &format!("shader: \"layers.wgsl\", color: [\"{dst}\"], bind: {{\"src\": {of}}}"));
    }

    /// Something that happens over time, and something that looks at it.
    pub(super) fn steps(&mut self) -> String {
        let swaps = 1 + self.below(3);
        // What may come from the camera happens once a frame.
        let sees = self.text.contains("seen.wgsl");
        let rate = ["60", "PerFrame"][if sees { 1 } else { self.below(2) as usize }];
        let before = self.passes;
        _ = writeln!(
            self.text,
            "      Steps(rate: {rate}, passes: [ Repeat(times: {swaps}, swap: [(\"old\", \"next\")], passes: ["
        );
        self.pass(
            "Compute",
            "shader: \"copy.wgsl\", each: Item(\"next\"), bind: {\"src\": \"old\", \"dst\": \"next\"}",
        );
        self.text.push_str("      ]),\n");
        self.passes = before + swaps as usize;
        self.pass("Compute", "shader: \"add.wgsl\", each: Item(\"old\"), bind: {\"dst\": \"old\"}");
        // What the frame made flows in, and what it made is changed.
        let is_written = |name: &str| self.things.iter().any(|thing| thing.name == name && thing.is_written());
        let (flows, changes) = (is_written("items_a"), is_written("items_b"));
        if self.below(2) == 0 && flows {
            self.pass(
                "Compute",
                "shader: \"feed.wgsl\", each: Item(\"old\"), bind: {\"src\": \"items_a\", \"dst\": \"old\"}",
            );
        }
        if self.below(3) == 0 && changes {
            self.pass("Compute", "shader: \"add.wgsl\", each: Item(\"items_b\"), bind: {\"dst\": \"items_b\"}");
        }
        self.text.push_str("      ]),\n");
        let dst = self.written(|what| matches!(what, What::Buffer { items: 100 }));
        let dst = self.name(dst);
        self.copy_items("old", &dst);
        dst
    }
}
